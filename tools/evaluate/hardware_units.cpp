#include "tools/evaluate/hardware_units.h"

#include <algorithm>
#include <stdexcept>

namespace beampipe {
namespace {

double over(double work, double rate) { return work / rate; }

// Operations on 64-bit integers are in the integer lanes, and issued twice. All that a shader reads and writes, except
// for texels, passes its core's L1 or shared memory.
double shader_clocks(const Rates& rates, const StageWork& s) {
  const auto& ops = s.ops;
  const double wide = static_cast<double>(ops.wide), total = static_cast<double>(ops.total());
  const double mul_add = static_cast<double>(ops.mul_add), add = static_cast<double>(ops.add);
  const double narrow = mul_add + add > 0 ? std::max(1 - wide / (mul_add + add), 0.0) : 0;
  return std::max(
      {over(total + wide, rates.of_cores("core_issue_per_clk")),
       narrow * (over(mul_add, rates.of_cores("core_mul_add_per_clk")) + over(add, rates.of_cores("core_add_per_clk"))),
       over(ops.bit, rates.of_cores("core_bit_per_clk")) + over(wide, rates.of_cores("core_wide_per_clk")),
       over(ops.fetch, rates.of_cores("core_fetch_per_clk")), over(ops.special, rates.of_cores("core_special_per_clk")),
       over(ops.convert, rates.of_cores("core_convert_per_clk")),
       over(s.logical_bytes() - s.texture_bytes, rates.of_cores("core_on_chip_bytes_per_clk"))});
}

// A thread waits for each of its operations and loads, and four threads together for a sector. Threads in flight wait
// at the same time.
double latency_clocks(const Rates& rates, const StageWork& s) {
  const auto operations = static_cast<double>(s.ops.total() + s.ops.wide - s.ops.fetch);
  const double loads = static_cast<double>(s.ops.fetch) + static_cast<double>(s.texture_bytes) / kProbeBytes;
  const double from_dram = std::min(static_cast<double>(s.dram_bytes), static_cast<double>(s.l2_bytes));
  const double from_l2 = static_cast<double>(s.l2_bytes) - from_dram;
  return (operations * rates.at("operation_clocks") + loads * rates.at("fetch_clocks") +
          4 / s.sector_bytes * (from_l2 * rates.at("l2_clocks") + from_dram * rates.at("dram_clocks"))) /
         s.threads;
}

// What is read and written where pixels are, by bytes of the formats: through the ROP's caches, or in the memory of the
// cores.
double pixel_clocks(const Rates& rates, const StageWork& s) {
  return over(s.logical_bytes(),
              s.pixels_on_chip ? rates.of_cores("core_on_chip_bytes_per_clk") : rates.at("rop_bytes_per_clk"));
}

}  // namespace

const std::vector<HardwareUnit>& hardware_units() {
  using Kind = HardwareUnit::Kind;
  static const std::vector<HardwareUnit> all = {
      {.name = "composer",
       .kind = Kind::fixed_function,
       .clocks =
           [](const Rates& rates, const StageWork& s) {
             return std::max({over(s.items_in, rates.at("rop_fragments_per_clk")),
                              over(s.position_tests, rates.at("compose_positions_per_clk")), pixel_clocks(rates, s)});
           },
       .is_rop = true},
      {.name = "conservative_raster",
       .kind = Kind::fixed_function,
       .clocks =
           [](const Rates& rates, const StageWork& s) {
             return std::max(over(s.items_in, rates.at("triangles_per_clk")),
                             over(s.lanes_used, rates.at("conservative_pixels_per_clk")));  // with hidden pixels
           }},
      {.name = kDram,
       .kind = Kind::implied,
       .clocks =
           [](const Rates& rates, const StageWork& s) {
             return over(s.dram_bytes, rates.at("dram_bytes_per_clk") * rates.at("dram_efficiency"));
           }},
      {.name = kExport,
       .kind = Kind::beside,
       .clocks = [](const Rates& rates,
                    const StageWork& s) { return over(s.bytes_written, rates.at("export_bytes_per_clk")); }},
      {.name = kL2,
       .kind = Kind::implied,
       .clocks = [](const Rates& rates, const StageWork& s) { return over(s.l2_bytes, rates.at("l2_bytes_per_clk")); }},
      {.name = kLatency, .kind = Kind::implied, .clocks = latency_clocks, .is_of_cores = true},
      {.name = "mask_generator",
       .kind = Kind::fixed_function,
       .clocks =
           [](const Rates& rates, const StageWork& s) {
             return std::max(over(s.items_in, rates.at("conservative_pixels_per_clk")),
                             over(s.position_tests, rates.at("mask_positions_per_clk")));
           }},
      {.name = "quads",
       .kind = Kind::beside,
       .clocks = [](const Rates& rates,
                    const StageWork& s) { return over(s.lanes_issued, 4 * rates.at("quads_per_clk")); }},
      {.name = "raster",
       .kind = Kind::fixed_function,
       .clocks =
           [](const Rates& rates, const StageWork& s) {
             return std::max(over(s.items_in, rates.at("triangles_per_clk")),
                             over(s.items_out, rates.at("raster_pixels_per_clk")));
           }},
      {.name = "rop_fragments",
       .kind = Kind::fixed_function,
       .clocks =
           [](const Rates& rates, const StageWork& s) {
             return std::max(over(s.items_in, rates.at("rop_fragments_per_clk")), pixel_clocks(rates, s));
           },
       .is_rop = true},
      {.name = "rop_samples",
       .kind = Kind::fixed_function,
       .clocks =
           [](const Rates& rates, const StageWork& s) {
             return std::max(over(s.items_in, rates.at("rop_samples_per_clk")), pixel_clocks(rates, s));
           },
       .is_rop = true},
      {.name = "shader", .kind = Kind::shader, .clocks = shader_clocks, .is_of_cores = true},
      {.name = "shading", .kind = Kind::shader, .clocks = shader_clocks},
      {.name = "sorter",
       .kind = Kind::fixed_function,
       .clocks =
           [](const Rates& rates, const StageWork& s) {
             return std::max(over(s.items_in, rates.at("rop_fragments_per_clk")),
                             over(s.ops.total(), rates.at("sort_operations_per_clk")));
           }},
      {.name = "texture",
       .kind = Kind::beside,
       .clocks = [](const Rates& rates,
                    const StageWork& s) { return over(s.texture_bytes, rates.of_cores("core_texture_bytes_per_clk")); },
       .is_of_cores = true},
      {.name = "triangles",
       .kind = Kind::beside,
       .clocks = [](const Rates& rates,
                    const StageWork& s) { return over(s.items_in, rates.at("triangles_per_clk")); }},
  };
  return all;
}

const HardwareUnit& info_of_unit(std::string_view name) {
  const auto& all = hardware_units();
  const auto found = std::find_if(all.begin(), all.end(), [&](const HardwareUnit& unit) { return unit.name == name; });
  if (found == all.end()) throw std::out_of_range("no unit " + std::string(name));
  return *found;
}

}  // namespace beampipe
