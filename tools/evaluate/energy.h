// Modelled energy: the work of each stage, times what described hardware needs for an operation and for a byte.
//
// Both have a low and a high value, so each energy is an interval: the sum of the low ones, and that of the high ones.
// It is the energy of switching alone. Leakage, clock trees, idle units, divergence and what draws the picture on a
// screen are left out, so a GPU takes more.
#pragma once

#include <span>
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

}  // namespace beampipe
