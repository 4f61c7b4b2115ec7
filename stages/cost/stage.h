// The stages of the pipeline in one table: what each is called, what it takes and gives, which counters it has, which
// kinds of hardware units can do its work, and what stands for it in plots.
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <iosfwd>
#include <optional>
#include <span>
#include <string_view>

namespace beampipe {

// In the order of the pipeline, as far as techniques have the same stages.
enum class StageId : std::uint8_t {
  vertex_setup,
  bin_sort,
  conservative_raster,
  sample_raster,
  reference_raster,
  a_buffer,
  windows,
  beam_fragment,
  alpha_mask,
  compose,
  alpha_test,
  depth_test,
  blend,
  stencil_test,
  accumulate,
  sample_select,
  material_sort,
  shade,
  light,
  motion,
  dilate,
  temporal,
  resolve,
  none,  // of counters that nobody adds up; not in the table
};
inline constexpr std::size_t kStageCount = static_cast<std::size_t>(StageId::none);

// A pass over the geometry. The stages of a depth pre-pass are counted apart, as "prepass_depth_test" and so on.
enum class Pass : std::uint8_t { prepass, main };

// A stage in a pass.
struct Stage {
  StageId id = StageId::none;
  Pass pass = Pass::main;

  constexpr Stage() = default;
  constexpr Stage(StageId stage, Pass of_pass = Pass::main) : id(stage), pass(of_pass) {}
  constexpr auto operator<=>(const Stage&) const = default;

  // 0 .. kStageNumbers - 1; those of a pre-pass come first.
  constexpr std::uint8_t number() const {
    return static_cast<std::uint8_t>(static_cast<std::size_t>(id) + (pass == Pass::main ? kStageCount + 1 : 0));
  }
  static constexpr Stage of_number(std::uint8_t number) {
    const bool is_main = number > kStageCount;
    return {static_cast<StageId>(is_main ? number - kStageCount - 1 : number), is_main ? Pass::main : Pass::prepass};
  }
};
inline constexpr std::size_t kStageNumbers = 2 * (kStageCount + 1);

// Groups of counters that a stage has or lacks as a whole, as bits.
using CounterGroups = std::uint32_t;
namespace counter_group {
enum Bit : CounterGroups {
  items = 1 << 0,  // items_in, items_out, and sums
  mul_add = 1 << 1,
  add = 1 << 2,
  bit = 1 << 3,
  fetch = 1 << 4,
  special = 1 << 5,
  convert = 1 << 6,
  wide = 1 << 7,
  reads = 1 << 8,
  writes = 1 << 9,
  sectors = 1 << 10,
  outer_memory = 1 << 11,  // bytes of L2 and of DRAM
  texels = 1 << 12,
  positions = 1 << 13,
  lanes = 1 << 14,
  hidden = 1 << 15,   // items and triangles that a rasterizer leaves out
  empties = 1 << 16,  // tiles without triangles
};
}  // namespace counter_group

enum class StageGroup : std::uint8_t { geometry, raster, fragments, visibility, shading, picture, reference };
std::string_view name_of(StageGroup group);

struct StageInfo {
  StageId id;
  std::string_view name;
  StageGroup group;
  std::string_view color;  // "#rrggbb"; stages that do similar work have similar hues
  // The kinds of units that a description of hardware may name for it.
  bool can_be_fixed_function = false, can_be_shader = false;
  bool rasterizes = false;  // it makes pairs or samples of triangles
  // It takes what belongs to a pixel in order, so that a pixel has one thread.
  bool works_by_pixel = false;
  CounterGroups counts;  // the counters that move in some scene
  // What its items and its lanes are; no lanes: empty.
  std::string_view items_in, items_out;
  std::string_view lanes_used = {}, lanes_issued = {};
};

// In the order of StageId.
std::span<const StageInfo, kStageCount> stage_list();

// Of a stage in the table.
inline const StageInfo& info_of(StageId id) { return stage_list()[static_cast<std::size_t>(id)]; }

// "depth_test", or "prepass_depth_test" in a depth pre-pass; empty for StageId::none.
std::string_view name_of(Stage stage);
std::ostream& operator<<(std::ostream& stream, Stage stage);

// The stage with that name, or none.
std::optional<Stage> find_stage(std::string_view name);

}  // namespace beampipe
