// Modelled energy: the work of each stage, times what described hardware needs for an operation and for a byte.
//
// Both have a low and a high value, so each energy is an interval: the sum of the low ones, and that of the high ones.
// It is the energy of switching alone. Leakage, clock trees, idle units, divergence and what draws the picture on a
// screen are left out, so a GPU takes more.
#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "stages/cost/counters.h"
#include "tools/evaluate/hardware.h"
#include "tools/evaluate/sensitivity.h"

namespace beampipe {

// Millijoules, by where they go.
struct Energy {
  Interval operations, instructions, on_chip, l2, dram;

  Energy& operator+=(const Energy& other);
  Interval total() const;
};

// A part of Energy, under its name in files.
struct EnergyTerm {
  const char* name;
  const char* meaning;
  Interval Energy::*part;
  bool by_implementation = false;  // it depends on the units of the stage
};

// All of them.
std::span<const EnergyTerm> energy_terms();

struct StageEnergy {
  Stage stage;
  Energy energy;
};

// Does the hardware say what operations and bytes take? Without it there is no energy.
inline bool has_energy(const Hardware& hardware) { return !hardware.picojoules.empty(); }

// Of each stage, in their order. The hardware has energies.
std::vector<StageEnergy> modelled_energy(const Hardware& hardware, const Implementation& implementation,
                                         const std::vector<StageCounters>& stages);

// Of all of them together.
Energy sum_of(const std::vector<StageEnergy>& stages);

// How many operations, instructions and bytes there are of each energy, by its name.
using PricedWork = std::map<std::string, double>;
PricedWork priced_work(const Hardware& hardware, const Implementation& implementation,
                       const std::vector<StageCounters>& stages);

// The least and the most that the energy of `work` can be, divided by that of `over`, if each energy lies anywhere in
// its range and is the same for both. `over` takes energy.
Interval quotient_of(const Hardware& hardware, const PricedWork& work, const PricedWork& over);

}  // namespace beampipe
