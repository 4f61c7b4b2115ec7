#include "tools/evaluate/modelled_time.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <queue>
#include <utility>

#include "tools/evaluate/hardware_units.h"

namespace beampipe {
namespace {

// The counters of a stage that shades, with the costs that come to its materials' own. Lighting is a stage of its own
// in some techniques. `registers`: that an invocation takes.
StageCounters with_costs(const Hardware& hardware, const StageCounters& stage, bool has_light, double& registers) {
  StageCounters priced = stage;
  const auto add = [&](const ShadingCost& cost) {
    constexpr double kMostInvocations = 1e11;  // so that nothing overflows, whatever a damaged report says
    const double invocations = std::min(static_cast<double>(stage.lanes_issued), kMostInvocations);
    priced.ops.mul_add += static_cast<std::uint64_t>(invocations * cost.operations / 2);
    priced.ops.add += static_cast<std::uint64_t>(invocations * cost.operations / 2);
    const auto texels = static_cast<std::uint64_t>(invocations * cost.fetches * kProbeBytes);
    priced.bytes_read += texels;
    priced.texture_bytes += texels;
    registers = std::max(registers, cost.registers);
  };
  if (stage.stage.id == StageId::shade) add(hardware.material);
  if (stage.stage.id == StageId::light || (stage.stage.id == StageId::shade && !has_light)) add(hardware.light);
  return priced;
}

bool has_stage(const std::vector<StageCounters>& stages, StageId id) {
  return std::any_of(stages.begin(), stages.end(), [id](const auto& s) { return s.stage.id == id; });
}

// The bins that have some of this work, at least 1.
double count_working(std::span<const std::uint64_t> bins) {
  const auto idle = std::count(bins.begin(), bins.end(), 0u);
  return std::max(static_cast<double>(bins.size()) - static_cast<double>(idle), 1.0);
}

// What a stage needs to know of its frame.
struct FrameKind {
  BinSize bin;
  double bins = 1, shaded_bins = 1;  // all that have work, and those in which something is shaded
  bool has_light = false;
  bool has_rops = true;  // the colours that are shaded go to ROPs
};

bool is_of_bins(const Stage& stage) { return stage.id != StageId::vertex_setup; }

// That a stage starts in all.
double threads_of_frame(const StageCounters& stage) {
  const bool is_shading = info_of(stage.stage.id).group == StageGroup::shading;
  return static_cast<double>(is_shading ? stage.lanes_issued : stage.items_in);
}

// The same in the mean bin. Pictures are made of empty bins, too.
double threads_of_bin(const StageCounters& stage, const FrameKind& frame) {
  const bool is_picture = info_of(stage.stage.id).group == StageGroup::picture;
  const double items = threads_of_frame(stage) / (is_picture ? frame.bins : frame.shaded_bins);
  return info_of(stage.stage.id).works_by_pixel ? std::min(items, frame.bin.pixels) : items;
}

// Those of bins are at most those of the bins that cores hold.
double threads_in_flight(const Hardware& hardware, const StageCounters& stage, const FrameKind& frame,
                         double registers) {
  double of_core = hardware.rates.at("core_threads");
  if (registers > 0) of_core = std::min(of_core, std::floor(hardware.rates.at("core_registers") / registers));
  const MemoryParameters& memory = hardware.memory;
  if (is_of_bins(stage.stage) && memory.binned && frame.bin.pixels > 0)
    of_core = std::min(of_core, threads_of_bin(stage, frame) * memory.bins_held(frame.bin.bytes, frame.bin.pixels));
  return std::clamp(hardware.memory.cores * of_core, 1.0, std::max(threads_of_frame(stage), 1.0));
}

// Of a unit: all, and by the rate that limits it.
struct UnitTime {
  double ms = 0;
  std::map<std::string, double> by_rate = {};

  bool operator<(const UnitTime& other) const { return ms < other.ms; }
  void operator+=(const UnitTime& other) {
    ms += other.ms;
    for (const auto& [rate, part] : other.by_rate) by_rate[rate] += part;
  }
};
using UnitTimes = std::map<std::string, UnitTime>;

UnitTimes times_of(const Hardware& hardware, const Implementation& implementation, const StageCounters& unpriced,
                   const FrameKind& frame) {
  double registers = 0;
  StageWork stage{with_costs(hardware, unpriced, frame.has_light, registers), frame.bin.bytes > 0};
  stage.threads = threads_in_flight(hardware, stage, frame, registers);
  stage.sector_bytes = hardware.memory.sector_bytes;
  const Rates rates(hardware);
  const double clocks_per_ms = hardware.clock_mhz * 1e3;
  UnitTimes times;
  const auto use = [&](const std::string& unit) {
    const Clocks clocks = info_of_unit(unit).clocks(rates, stage);
    const double ms = clocks.count / clocks_per_ms;
    times[unit] = {ms, {{clocks.rate, ms}}};
  };
  if (const auto found = implementation.units.find(stage.stage.id); found != implementation.units.end())
    for (const std::string& unit : found->second) use(unit);
  if (!frame.has_rops) times.erase(kExport);
  if (const auto shading = times.extract("shading"))                // the same lanes
    times["shader"] = std::max(shading.mapped(), times["shader"]);  // which may be new
  if (times.contains("shader")) use(kLatency);
  use(kL2);
  use(kDram);
  return times;
}

// Does the implementation do any of these stages in ROPs? What `resolve` reads has been there before.
bool has_rops(const Implementation& implementation, const std::vector<StageCounters>& stages) {
  const auto is_rop = [](const std::string& unit) { return info_of_unit(unit).is_rop; };
  return std::any_of(stages.begin(), stages.end(), [&](const StageCounters& stage) {
    const auto found = implementation.units.find(stage.stage.id);
    return stage.stage.id != StageId::resolve && found != implementation.units.end() &&
           std::any_of(found->second.begin(), found->second.end(), is_rop);
  });
}

void add_times(UnitTimes& busy, const UnitTimes& times) {
  for (const auto& [unit, time] : times) busy[unit] += time;
}

struct Busiest {
  std::string unit, rate;
  double ms = 0;
};

Busiest busiest_of(const UnitTimes& times) {
  Busiest most;
  for (const auto& [unit, time] : times) {
    if (time.ms < most.ms) continue;
    const auto of_part = [](const auto& part) { return part.second; };
    most = {unit, std::ranges::max_element(time.by_rate, {}, of_part)->first, time.ms};
  }
  return most;
}

// Times of bins on cores: the sums over stages of what units of cores and shared ones do, and of what a core needs for
// its part of the bins, if all that it holds do their stages one after the other.
struct BinTimes {
  UnitTimes of_cores, shared;
  double stages_in_turn_ms = 0;

  void add(const UnitTimes& stage, double bins_held, double cores) {
    double alone = 0;  // all bins one by one on each core: latency is that of one bin's threads, shared units are free
    for (const auto& [unit, time] : stage) {
      const double ms = time.ms;
      (info_of_unit(unit).is_of_cores ? of_cores : shared)[unit] += time;
      alone = std::max(alone, unit == kLatency ? ms * bins_held : info_of_unit(unit).is_of_cores ? ms : ms / cores);
    }
    stages_in_turn_ms += alone / bins_held;
  }

  double ms(double busiest_core) const {
    const double core = std::max(busiest_of(of_cores).ms, stages_in_turn_ms);
    return std::max(busiest_of(shared).ms, core * busiest_core);
  }
};

// How much longer the busiest of `cores` works than they do on average. 1 if there is no work.
double of_busiest_core(const std::vector<double>& bins, std::uint32_t cores) {
  std::priority_queue<double, std::vector<double>, std::greater<>> free_at;
  for (std::uint32_t i = 0; i < cores; ++i) free_at.push(0);
  double last = 0;
  for (const double work : bins) {
    const double end = free_at.top() + work;
    free_at.pop();
    free_at.push(end);
    last = std::max(last, end);
  }
  const double all = std::accumulate(bins.begin(), bins.end(), 0.0);
  return all == 0 ? 1 : last * cores / all;
}

}  // namespace

std::map<std::string, double> unit_times(const Hardware& hardware, const Implementation& implementation,
                                         const StageCounters& stage, const BinSize& bin, double bins) {
  std::map<std::string, double> times;
  for (const auto& [unit, time] : times_of(hardware, implementation, stage, {bin, bins, bins})) times[unit] = time.ms;
  return times;
}

BinSpread bin_spread(const Hardware& hardware, const FrameWork& work) {
  if (!hardware.memory.binned) return {};
  const double of_invocation = hardware.material.operations + hardware.light.operations;
  std::vector<double> bins(work.bin_operations.begin(), work.bin_operations.end());
  for (std::size_t i = 0; i < std::min(bins.size(), work.bin_invocations.size()); ++i)
    bins[i] += static_cast<double>(work.bin_invocations[i]) * of_invocation;
  BinSpread spread{.busiest_core = of_busiest_core(bins, hardware.memory.cores)};
  const auto count = static_cast<double>(bins.size());
  const double mean = std::accumulate(bins.begin(), bins.end(), 0.0) / count;
  if (!(mean > 0)) return spread;
  std::sort(bins.begin(), bins.end());
  spread.p99 = bins[(99 * bins.size() + 99) / 100 - 1] / mean;
  spread.most = bins.back() / mean;
  return spread;
}

std::vector<StageCounters> with_shading(const Hardware& hardware, const std::vector<StageCounters>& stages) {
  std::vector<StageCounters> priced;
  double registers = 0;
  for (const StageCounters& stage : stages)
    priced.push_back(with_costs(hardware, stage, has_stage(stages, StageId::light), registers));
  return priced;
}

ModelledTime modelled_time(const Hardware& hardware, const Implementation& implementation, const FrameWork& work) {
  const FrameKind frame{work.bin, count_working(work.bin_operations), count_working(work.bin_invocations),
                        has_stage(work.stages, StageId::light), has_rops(implementation, work.stages)};
  const double held = hardware.memory.bins_held(work.bin.bytes, work.bin.pixels);
  ModelledTime time;
  UnitTimes all, before;
  BinTimes of_bins;
  for (const StageCounters& stage : work.stages) {
    const UnitTimes of_stage = times_of(hardware, implementation, stage, frame);
    add_times(all, of_stage);
    if (is_of_bins(stage.stage)) {
      of_bins.add(of_stage, held, hardware.memory.cores);
    } else {
      add_times(before, of_stage);
    }
    const Busiest busiest = busiest_of(of_stage);
    time.stages.push_back({stage.stage, busiest.ms, busiest.unit, busiest.rate});
    time.in_turn_ms += busiest.ms;
  }
  time.on_cores_ms = busiest_of(before).ms + of_bins.ms(bin_spread(hardware, work).busiest_core);
  const Busiest busiest = busiest_of(all);
  time.at_once_ms = busiest.ms, time.busiest = busiest.unit, time.busiest_rate = busiest.rate;
  return time;
}

}  // namespace beampipe
