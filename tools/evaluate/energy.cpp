#include "tools/evaluate/energy.h"

#include <algorithm>

#include "tools/evaluate/hardware_units.h"
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
                     [](const std::string& unit) { return info_of_unit(unit).kind == HardwareUnit::Kind::shader; });
}

using Count = std::uint64_t;

// What each energy of a description is the price of, and the part of Energy that it belongs to. Instructions are
// counted as in modelled times: those on 64-bit integers are issued twice.
struct Price {
  const char* name;
  Interval Energy::*part;
  Count (*count)(const StageCounters& stage);
};
constexpr Price kPrices[] = {
    {"mul_add", &Energy::operations, [](const StageCounters& s) -> Count { return s.ops.mul_add; }},
    {"add", &Energy::operations, [](const StageCounters& s) -> Count { return s.ops.add; }},
    {"bit", &Energy::operations, [](const StageCounters& s) -> Count { return s.ops.bit; }},
    {"fetch", &Energy::operations, [](const StageCounters& s) -> Count { return s.ops.fetch; }},
    {"special", &Energy::operations, [](const StageCounters& s) -> Count { return s.ops.special; }},
    {"convert", &Energy::operations, [](const StageCounters& s) -> Count { return s.ops.convert; }},
    {"wide", &Energy::operations, [](const StageCounters& s) -> Count { return s.ops.wide; }},
    {"instruction", &Energy::instructions, [](const StageCounters& s) -> Count { return s.ops.total() + s.ops.wide; }},
    {"on_chip_byte", &Energy::on_chip,
     [](const StageCounters& s) -> Count { return s.logical_bytes() - std::min(s.texture_bytes, s.logical_bytes()); }},
    {"texture_byte", &Energy::on_chip, [](const StageCounters& s) -> Count { return s.texture_bytes; }},
    {"l2_byte", &Energy::l2, [](const StageCounters& s) -> Count { return s.l2_bytes; }},
    {"dram_byte", &Energy::dram, [](const StageCounters& s) -> Count { return s.dram_bytes; }},
};

// Fixed functions have no instructions.
double count_of(const Price& price, const Implementation& implementation, const StageCounters& stage) {
  const bool is_paid = price.part != &Energy::instructions || runs_on_shaders(implementation, stage.stage.id);
  return is_paid ? static_cast<double>(price.count(stage)) : 0;
}

Energy energy_of(const Hardware& hardware, const Implementation& implementation, const StageCounters& stage) {
  Energy energy;
  for (const Price& price : kPrices) {
    const double count = count_of(price, implementation, stage) * kMillijoules;
    const RateRange& each = hardware.picojoules.at(price.name);
    energy.*price.part += {count * each.low, count * each.high};
  }
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
    all.push_back({stage.stage, energy_of(hardware, implementation, stage)});
  return all;
}

PricedWork priced_work(const Hardware& hardware, const Implementation& implementation,
                       const std::vector<StageCounters>& stages) {
  PricedWork work;
  for (const StageCounters& stage : with_shading(hardware, stages))
    for (const Price& price : kPrices) work[price.name] += count_of(price, implementation, stage);
  return work;
}

// A quotient of sums is greatest if all energies of which `work` has more than its share are at their highest, and the
// others at their lowest. How much is more depends on the quotient, so each place to part them is tried.
Interval quotient_of(const Hardware& hardware, const PricedWork& work, const PricedWork& over) {
  std::vector<std::string> names;
  for (const auto& [name, count] : work) names.push_back(name);
  std::sort(names.begin(), names.end(), [&](const std::string& a, const std::string& b) {
    return work.at(a) * over.at(b) < work.at(b) * over.at(a);
  });
  const auto quotient = [&](std::size_t parted_at, bool first_are_high) {
    double sum = 0, of_over = 0;
    for (std::size_t i = 0; i < names.size(); ++i) {
      const RateRange& each = hardware.picojoules.at(names[i]);
      const double picojoules = (i < parted_at) == first_are_high ? each.high : each.low;
      sum += work.at(names[i]) * picojoules;
      of_over += over.at(names[i]) * picojoules;
    }
    return sum / of_over;
  };
  Interval interval = {quotient(0, true), quotient(0, true)};
  for (std::size_t i = 0; i <= names.size(); ++i) {
    interval.low = std::min(interval.low, quotient(i, true));
    interval.high = std::max(interval.high, quotient(i, false));
  }
  return interval;
}

Energy sum_of(const std::vector<StageEnergy>& stages) {
  Energy sum;
  for (const StageEnergy& stage : stages) sum += stage.energy;
  return sum;
}

}  // namespace beampipe
