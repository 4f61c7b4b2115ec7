#include "tools/evaluate/modelled_time.h"

#include <algorithm>
#include <functional>
#include <numeric>
#include <queue>
#include <tuple>
#include <utility>

namespace beampipe {
namespace {

using Rates = std::map<std::string, double>;
constexpr const char *kL2 = "l2", *kDram = "dram", *kExport = "export";

struct StageWork : StageCounters {
  bool pixels_on_chip = false;  // the state of pixels that it reads and writes; otherwise it is in memory
};

// The clocks that a unit needs for the work of a stage.
using Clocks = std::function<double(const Rates& rates, const StageWork& stage)>;

constexpr double kProbeBytes = 16;  // a bilinear probe: four texels of 4 bytes

double over(double work, double rate) { return work / rate; }

// Operations on 64-bit integers are in the integer lanes, and issued twice. All that a shader reads and writes, except
// for texels, passes its core's L1 or shared memory.
double shader_clocks(const Rates& rates, const StageWork& s) {
  const auto& ops = s.ops;
  const double wide = static_cast<double>(ops.wide), total = static_cast<double>(ops.total());
  const double mul_add = static_cast<double>(ops.mul_add), add = static_cast<double>(ops.add);
  const double narrow = mul_add + add > 0 ? std::max(1 - wide / (mul_add + add), 0.0) : 0;
  return std::max({over(total + wide, rates.at("issue_per_clk")),
                   narrow * (over(mul_add, rates.at("mul_add_per_clk")) + over(add, rates.at("add_per_clk"))),
                   over(ops.bit, rates.at("bit_per_clk")) + over(wide, rates.at("wide_per_clk")),
                   over(ops.fetch, rates.at("fetch_per_clk")), over(ops.special, rates.at("special_per_clk")),
                   over(ops.convert, rates.at("convert_per_clk")),
                   over(s.logical_bytes() - s.texture_bytes, rates.at("on_chip_bytes_per_clk"))});
}

// What is read and written where pixels are, by bytes of the formats: through the ROP's caches, or in the memory of the
// cores.
double pixel_clocks(const Rates& rates, const StageWork& s) {
  return over(s.logical_bytes(), rates.at(s.pixels_on_chip ? "on_chip_bytes_per_clk" : "rop_bytes_per_clk"));
}

const std::map<std::string, Clocks>& units() {
  static const std::map<std::string, Clocks> all = {
      {"triangles",
       [](const Rates& rates, const StageWork& s) { return over(s.items_in, rates.at("triangles_per_clk")); }},
      {"raster",
       [](const Rates& rates, const StageWork& s) {
         return std::max(over(s.items_in, rates.at("triangles_per_clk")),
                         over(s.items_out, rates.at("raster_pixels_per_clk")));
       }},
      {"conservative_raster",
       [](const Rates& rates, const StageWork& s) {
         return std::max(over(s.items_in, rates.at("triangles_per_clk")),
                         over(s.lanes_used, rates.at("conservative_pixels_per_clk")));  // with hidden pixels
       }},
      {"quads",
       [](const Rates& rates, const StageWork& s) { return over(s.lanes_issued, 4 * rates.at("quads_per_clk")); }},
      {kExport,
       [](const Rates& rates, const StageWork& s) { return over(s.bytes_written, rates.at("export_bytes_per_clk")); }},
      {"shader", shader_clocks},
      {"shading", shader_clocks},
      {"texture",
       [](const Rates& rates, const StageWork& s) { return over(s.texture_bytes, rates.at("texture_bytes_per_clk")); }},
      {"mask_generator",
       [](const Rates& rates, const StageWork& s) {
         return std::max(over(s.items_in, rates.at("conservative_pixels_per_clk")),
                         over(s.position_tests, rates.at("mask_positions_per_clk")));
       }},
      {"sorter",
       [](const Rates& rates, const StageWork& s) {
         return std::max(over(s.items_in, rates.at("rop_fragments_per_clk")),
                         over(s.ops.total(), rates.at("sort_operations_per_clk")));
       }},
      {"composer",
       [](const Rates& rates, const StageWork& s) {
         return std::max({over(s.items_in, rates.at("rop_fragments_per_clk")),
                          over(s.position_tests, rates.at("compose_positions_per_clk")), pixel_clocks(rates, s)});
       }},
      {"rop_samples",
       [](const Rates& rates, const StageWork& s) {
         return std::max(over(s.items_in, rates.at("rop_samples_per_clk")), pixel_clocks(rates, s));
       }},
      {"rop_fragments",
       [](const Rates& rates, const StageWork& s) {
         return std::max(over(s.items_in, rates.at("rop_fragments_per_clk")), pixel_clocks(rates, s));
       }},
      {"l2", [](const Rates& rates, const StageWork& s) { return over(s.l2_bytes, rates.at("l2_bytes_per_clk")); }},
      {"dram",
       [](const Rates& rates, const StageWork& s) {
         return over(s.dram_bytes, rates.at("dram_bytes_per_clk") * rates.at("dram_efficiency"));
       }},
  };
  return all;
}

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

// What a stage needs to know of the frame's other stages.
struct FrameKind {
  bool has_light = false;
  bool has_rops = true;  // the colours that are shaded go to ROPs
};

std::map<std::string, double> times_of(const Hardware& hardware, const Implementation& implementation,
                                       const StageCounters& unpriced, const FrameKind& frame, double bin_bytes) {
  double registers = 0;
  const StageWork stage{with_costs(hardware, unpriced, frame.has_light, registers), bin_bytes > 0};
  const Rates& rates = hardware.rates;
  const double clocks_per_ms = hardware.clock_mhz * 1e3;
  std::map<std::string, double> times;
  const auto use = [&](const std::string& unit) { times[unit] = units().at(unit)(rates, stage) / clocks_per_ms; };
  bool on_chip = false;
  if (const auto found = implementation.units.find(stage.stage.id); found != implementation.units.end())
    for (const std::string& unit : found->second) unit == kOnChipMark ? static_cast<void>(on_chip = true) : use(unit);
  if (!frame.has_rops) times.erase(kExport);
  if (const auto shading = times.find("shading"); shading != times.end())
    shading->second *= std::max(1.0, registers / rates.at("registers_at_full_rate"));
  if (on_chip && bin_bytes > 0)
    for (auto& [unit, ms] : times)
      ms *= static_cast<double>(hardware.memory.bins_per_core) / bins_held(hardware.memory, bin_bytes);
  use(kL2);
  use(kDram);
  return times;
}

bool has_stage(const std::vector<StageCounters>& stages, StageId id) {
  return std::any_of(stages.begin(), stages.end(), [id](const auto& s) { return s.stage.id == id; });
}

// Does the implementation do any of these stages in ROPs?
bool has_rops(const Implementation& implementation, const std::vector<StageCounters>& stages) {
  const auto is_rop = [](const std::string& unit) {
    return unit == "rop_samples" || unit == "rop_fragments" || unit == "composer";
  };
  return std::any_of(stages.begin(), stages.end(), [&](const StageCounters& stage) {
    const auto found = implementation.units.find(stage.stage.id);
    return found != implementation.units.end() && std::any_of(found->second.begin(), found->second.end(), is_rop);
  });
}

void add_times(std::map<std::string, double>& busy, const std::map<std::string, double>& times) {
  for (const auto& [unit, ms] : times) busy[unit] += ms;
}

std::pair<std::string, double> busiest_of(const std::map<std::string, double>& times) {
  std::pair<std::string, double> most;
  for (const auto& [unit, ms] : times)
    if (ms >= most.second) most = {unit, ms};
  return most;
}

// Units of which each core has its part. The others serve all bins.
bool is_of_cores(const std::string& unit) {
  for (const char* const each : {"shader", "texture", "quads", "mask_generator", "sorter", "composer"})
    if (unit == each) return true;
  return false;
}

double on_cores_ms(const std::map<std::string, double>& of_bins, const std::map<std::string, double>& before,
                   double times_longer) {
  double longest = 0;
  for (const auto& [unit, ms] : of_bins) longest = std::max(longest, is_of_cores(unit) ? ms * times_longer : ms);
  return busiest_of(before).second + longest;
}

}  // namespace

std::vector<std::string> unit_names() {
  std::vector<std::string> names;
  for (const auto& [name, clocks] : units()) names.push_back(name);
  return names;
}

std::map<std::string, double> unit_times(const Hardware& hardware, const Implementation& implementation,
                                         const StageCounters& stage, double bin_bytes) {
  return times_of(hardware, implementation, stage, {}, bin_bytes);
}

std::uint32_t bins_held(const MemoryParameters& memory, double bin_bytes) {
  const double room = std::max(memory.on_chip_bytes / std::max(bin_bytes, 1.0), 1.0);
  return static_cast<std::uint32_t>(std::min(room, static_cast<double>(memory.bins_per_core)));
}

double imbalance(std::span<const std::uint64_t> bin_operations, std::uint32_t cores) {
  std::priority_queue<std::uint64_t, std::vector<std::uint64_t>, std::greater<>> free_at;
  for (std::uint32_t i = 0; i < cores; ++i) free_at.push(0);
  std::uint64_t last = 0;
  for (const std::uint64_t operations : bin_operations) {
    const std::uint64_t end = free_at.top() + operations;
    free_at.pop();
    free_at.push(end);
    last = std::max(last, end);
  }
  const auto all = std::accumulate(bin_operations.begin(), bin_operations.end(), std::uint64_t{0});
  return all == 0 ? 1 : static_cast<double>(last) * cores / static_cast<double>(all);
}

std::vector<StageCounters> with_shading(const Hardware& hardware, const std::vector<StageCounters>& stages) {
  std::vector<StageCounters> priced;
  double registers = 0;
  for (const StageCounters& stage : stages)
    priced.push_back(with_costs(hardware, stage, has_stage(stages, StageId::light), registers));
  return priced;
}

ModelledTime modelled_time(const Hardware& hardware, const Implementation& implementation, const FrameWork& work) {
  const FrameKind frame{has_stage(work.stages, StageId::light), has_rops(implementation, work.stages)};
  ModelledTime time;
  std::map<std::string, double> before, of_bins;
  for (const StageCounters& stage : work.stages) {
    std::map<std::string, double> of_stage = times_of(hardware, implementation, stage, frame, work.bin_bytes);
    if (const auto shading = of_stage.extract("shading"))  // the same lanes
      of_stage["shader"] = std::max(of_stage["shader"], shading.mapped());
    add_times(stage.stage.id == StageId::vertex_setup ? before : of_bins, of_stage);
    const auto [unit, ms] = busiest_of(of_stage);
    time.stages.push_back({stage.stage, ms, unit});
    time.in_turn_ms += ms;
  }
  time.on_cores_ms = on_cores_ms(of_bins, before, imbalance(work.bin_operations, hardware.memory.cores));
  add_times(of_bins, before);
  std::tie(time.busiest, time.at_once_ms) = busiest_of(of_bins);
  return time;
}

}  // namespace beampipe
