#include "tools/evaluate/energy.h"

#include <algorithm>

#include "tools/evaluate/modelled_time.h"

namespace beampipe {
namespace {

constexpr EnergyTerm kTerms[] = {
    {"operations", "arithmetic and look-ups in tables", &Energy::operations},
    {"instructions", "to fetch, decode and issue instructions and move their operands, where shaders do the work",
     &Energy::instructions, true},
    {"on_chip", "all that is read and written, in the memory next to the units, and the filters of textures",
     &Energy::on_chip},
    {"l2", "bytes of L2", &Energy::l2},
    {"dram", "bytes of DRAM", &Energy::dram},
};

constexpr double kMillijoules = 1e-9;  // in a picojoule

Interval& operator+=(Interval& sum, const Interval& other) {
  sum.low += other.low;
  sum.high += other.high;
  return sum;
}

bool runs_on_shaders(const Implementation& implementation, StageId stage) {
  const auto units = implementation.units.find(stage);
  return units != implementation.units.end() &&
         std::any_of(units->second.begin(), units->second.end(),
                     [](const std::string& unit) { return unit == "shader" || unit == "shading"; });
}

Energy energy_of(const Hardware& hardware, const StageCounters& stage, bool on_shaders) {
  Energy energy;
  const auto add = [&](Interval& part, std::uint64_t count, const char* name) {
    const RateRange& each = hardware.picojoules.at(name);
    part +=
        {static_cast<double>(count) * each.low * kMillijoules, static_cast<double>(count) * each.high * kMillijoules};
  };
  add(energy.operations, stage.ops.mul_add, "mul_add");
  add(energy.operations, stage.ops.add, "add");
  add(energy.operations, stage.ops.bit, "bit");
  add(energy.operations, stage.ops.fetch, "fetch");
  add(energy.operations, stage.ops.special, "special");
  add(energy.operations, stage.ops.convert, "convert");
  add(energy.operations, stage.ops.wide, "wide");
  if (on_shaders) add(energy.instructions, stage.ops.total() + stage.ops.wide, "instruction");  // as in modelled times
  add(energy.on_chip, stage.logical_bytes() - std::min(stage.texture_bytes, stage.logical_bytes()), "on_chip_byte");
  add(energy.on_chip, stage.texture_bytes, "texture_byte");
  add(energy.l2, stage.l2_bytes, "l2_byte");
  add(energy.dram, stage.dram_bytes, "dram_byte");
  return energy;
}

}  // namespace

std::span<const EnergyTerm> energy_terms() { return kTerms; }

Energy& Energy::operator+=(const Energy& other) {
  for (const EnergyTerm& term : kTerms) this->*term.part += other.*term.part;
  return *this;
}

Interval Energy::total() const {
  Interval sum;
  for (const EnergyTerm& term : kTerms) sum += this->*term.part;
  return sum;
}

std::vector<StageEnergy> modelled_energy(const Hardware& hardware, const Implementation& implementation,
                                         const std::vector<StageCounters>& stages) {
  std::vector<StageEnergy> all;
  for (const StageCounters& stage : with_shading(hardware, stages))
    all.push_back({stage.stage, energy_of(hardware, stage, runs_on_shaders(implementation, stage.stage.id))});
  return all;
}

Energy sum_of(const std::vector<StageEnergy>& stages) {
  Energy sum;
  for (const StageEnergy& stage : stages) sum += stage.energy;
  return sum;
}

}  // namespace beampipe
