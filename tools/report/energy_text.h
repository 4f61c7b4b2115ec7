// Modelled energy of finished runs, and what stands for area, as a table for the terminal and as JSON.
#pragma once

#include <string>

#include "tools/evaluate/results.h"

namespace beampipe {

// A row per technique and implementation: millijoules, all and by where they go, and watts while bins are on cores;
// memory on chip for the pixels of all bins that all cores hold, in KiB; and what units of fixed function that the
// technique uses compare per clock. Means over the frames; the last two are those of the first. The reference has no
// row. With a technique `over`, also the energies of the others over its energy (quotient_of). The report's hardware
// has energies.
std::string energy_text(const Report& report, const std::string& over = "");

// An array of objects with the same, and the energy of each stage.
Json energy_json(const Report& report, const std::string& over = "");

}  // namespace beampipe
