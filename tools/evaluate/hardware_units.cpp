#include "tools/evaluate/hardware_units.h"

#include <algorithm>
#include <stdexcept>

namespace beampipe {
namespace {

// Operations on 64-bit integers are in the integer lanes, and issued twice. All that a shader reads and writes, except
// for texels, passes its core's L1 or shared memory.
Clocks shader_clocks(const Rates& rates, const StageWork& s) {
  const auto& ops = s.ops;
  const double wide = static_cast<double>(ops.wide), total = static_cast<double>(ops.total());
  const double mul_add = static_cast<double>(ops.mul_add), add = static_cast<double>(ops.add);
  const double narrow = mul_add + add > 0 ? std::max(1 - wide / (mul_add + add), 0.0) : 0;
  Clocks floats = rates.over_cores(mul_add, "core_mul_add_per_clk") + rates.over_cores(add, "core_add_per_clk");
  floats.count *= narrow;
  return std::max({rates.over_cores(total + wide, "core_issue_per_clk"), floats,
                   rates.over_cores(ops.bit, "core_bit_per_clk") + rates.over_cores(wide, "core_wide_per_clk"),
                   rates.over_cores(ops.fetch, "core_fetch_per_clk"),
                   rates.over_cores(ops.special, "core_special_per_clk"),
                   rates.over_cores(ops.convert, "core_convert_per_clk"),
                   rates.over_cores(s.logical_bytes() - s.texture_bytes, "core_on_chip_bytes_per_clk")});
}

// A thread waits for each of its operations and loads, and four threads together for a sector. Threads in flight wait
// at the same time.
Clocks latency_clocks(const Rates& rates, const StageWork& s) {
  const auto waits = [&](double times, const char* clocks) { return Clocks{times * rates.at(clocks), clocks}; };
  const auto operations = static_cast<double>(s.ops.total() + s.ops.wide - s.ops.fetch);
  const double loads = static_cast<double>(s.ops.fetch) + static_cast<double>(s.texture_bytes) / kProbeBytes;
  const double from_dram = std::min(static_cast<double>(s.dram_bytes), static_cast<double>(s.l2_bytes));
  const double from_l2 = static_cast<double>(s.l2_bytes) - from_dram;
  Clocks sectors = waits(from_l2, "l2_clocks") + waits(from_dram, "dram_clocks");
  sectors.count *= 4 / s.sector_bytes;
  Clocks all = waits(operations, "operation_clocks") + waits(loads, "fetch_clocks") + sectors;
  all.count /= s.threads;
  return all;
}

// What is read and written where pixels are, by bytes of the formats: through the ROP's caches, or in the memory of the
// cores.
Clocks pixel_clocks(const Rates& rates, const StageWork& s) {
  return s.pixels_on_chip ? rates.over_cores(s.logical_bytes(), "core_on_chip_bytes_per_clk")
                          : rates.over(s.logical_bytes(), "rop_bytes_per_clk");
}

}  // namespace

const std::vector<HardwareUnit>& hardware_units() {
  using Kind = HardwareUnit::Kind;
  static const std::vector<HardwareUnit> all = {
      {.name = "composer",
       .kind = Kind::fixed_function,
       .clocks =
           [](const Rates& rates, const StageWork& s) {
             return std::max({rates.over(s.items_in, "rop_fragments_per_clk"),
                              rates.over(s.position_tests, "compose_positions_per_clk"), pixel_clocks(rates, s)});
           },
       .is_rop = true},
      {.name = "conservative_raster",
       .kind = Kind::fixed_function,
       .clocks =
           [](const Rates& rates, const StageWork& s) {
             return std::max(rates.over(s.items_in, "triangles_per_clk"),
                             rates.over(s.lanes_used, "conservative_pixels_per_clk"));  // with hidden pixels
           }},
      {.name = kDram,
       .kind = Kind::implied,
       .clocks =
           [](const Rates& rates, const StageWork& s) {
             constexpr const char* kPeak = "dram_bytes_per_clk";
             return Clocks{s.dram_bytes / (rates.at(kPeak) * rates.at(kDramEfficiency)), kPeak};
           }},
      {.name = kExport,
       .kind = Kind::beside,
       .clocks = [](const Rates& rates,
                    const StageWork& s) { return rates.over(s.bytes_written, "export_bytes_per_clk"); }},
      {.name = kL2,
       .kind = Kind::implied,
       .clocks = [](const Rates& rates, const StageWork& s) { return rates.over(s.l2_bytes, "l2_bytes_per_clk"); }},
      {.name = kLatency, .kind = Kind::implied, .clocks = latency_clocks, .is_of_cores = true},
      {.name = "mask_generator",
       .kind = Kind::fixed_function,
       .clocks =
           [](const Rates& rates, const StageWork& s) {
             return std::max(rates.over(s.items_in, "conservative_pixels_per_clk"),
                             rates.over(s.position_tests, "mask_positions_per_clk"));
           }},
      {.name = "quads",
       .kind = Kind::beside,
       .clocks = [](const Rates& rates,
                    const StageWork& s) { return rates.over(s.lanes_issued / 4.0, "quads_per_clk"); }},
      {.name = "raster",
       .kind = Kind::fixed_function,
       .clocks =
           [](const Rates& rates, const StageWork& s) {
             return std::max(rates.over(s.items_in, "triangles_per_clk"),
                             rates.over(s.items_out, "raster_pixels_per_clk"));
           }},
      {.name = "rop_fragments",
       .kind = Kind::fixed_function,
       .clocks =
           [](const Rates& rates, const StageWork& s) {
             return std::max(rates.over(s.items_in, "rop_fragments_per_clk"), pixel_clocks(rates, s));
           },
       .is_rop = true},
      {.name = "rop_samples",
       .kind = Kind::fixed_function,
       .clocks =
           [](const Rates& rates, const StageWork& s) {
             return std::max(rates.over(s.items_in, "rop_samples_per_clk"), pixel_clocks(rates, s));
           },
       .is_rop = true},
      {.name = "shader", .kind = Kind::shader, .clocks = shader_clocks, .is_of_cores = true},
      {.name = "shading", .kind = Kind::shader, .clocks = shader_clocks},
      {.name = "sorter",
       .kind = Kind::fixed_function,
       .clocks =
           [](const Rates& rates, const StageWork& s) {
             return std::max(rates.over(s.items_in, "rop_fragments_per_clk"),
                             rates.over(s.ops.total(), "sort_operations_per_clk"));
           }},
      {.name = "texture",
       .kind = Kind::beside,
       .clocks = [](const Rates& rates,
                    const StageWork& s) { return rates.over_cores(s.texture_bytes, "core_texture_bytes_per_clk"); },
       .is_of_cores = true},
      {.name = "triangles",
       .kind = Kind::beside,
       .clocks = [](const Rates& rates, const StageWork& s) { return rates.over(s.items_in, "triangles_per_clk"); }},
  };
  return all;
}

const HardwareUnit& info_of_unit(std::string_view name) {
  const auto& all = hardware_units();
  const auto found = std::find_if(all.begin(), all.end(), [&](const HardwareUnit& unit) { return unit.name == name; });
  if (found == all.end()) throw std::out_of_range("no unit " + std::string(name));
  return *found;
}

std::string limit_text(const std::string& unit, const std::string& rate) {
  constexpr std::string_view kOfCore = "core_", kPerClock = "_per_clk";
  std::string_view what = rate;
  if (what.starts_with(kOfCore)) what.remove_prefix(kOfCore.size());
  if (what.ends_with(kPerClock)) what.remove_suffix(kPerClock.size());
  return what.starts_with(unit) || what.empty() ? unit : unit + ": " + std::string(what);
}

}  // namespace beampipe
