#include "stages/cost/stage.h"

#include <algorithm>
#include <array>
#include <ostream>
#include <string>

namespace beampipe {
namespace {

using namespace counter_group;
using enum StageGroup;

constexpr CounterGroups kMemory = reads | writes | sectors | outer_memory;
constexpr CounterGroups kArithmetic = mul_add | add | bit | fetch | special | convert;
constexpr CounterGroups kRaster = hidden | empties | lanes | wide;

// Blue stands for geometry and bins, teal for rasters, orange for fragments, yellow for shading, brown for the
// A-buffer, red for composition, green for samples, purple for sample selection.
constexpr std::array<StageInfo, kStageCount> kStages = {{
    {.id = StageId::vertex_setup,
     .name = "vertex_setup",
     .group = geometry,
     .color = "#4e79a7",
     .can_be_fixed_function = true,
     .can_be_shader = true,
     .counts = items | (kArithmetic & ~fetch) | wide | kMemory,
     .items_in = "triangles of the draws, counted in each pass",
     .items_out = "setup triangles, counted in each pass"},
    {.id = StageId::bin_sort,
     .name = "bin_sort",
     .group = raster,
     .color = "#a0cbe8",
     .can_be_fixed_function = true,
     .can_be_shader = true,
     .counts = items | (kArithmetic & ~special) | kMemory,
     .items_in = "triangles of the bins' lists",
     .items_out = "the same triangles, near to far"},
    {.id = StageId::conservative_raster,
     .name = "conservative_raster",
     .group = raster,
     .color = "#76b7b2",
     .can_be_fixed_function = true,
     .rasterizes = true,
     .counts = items | (kArithmetic & ~(fetch | special)) | kMemory | kRaster,
     .items_in = "setup triangles",
     .items_out = "pairs that may be visible",
     .lanes_used = "pixels that a triangle touches",
     .lanes_issued = "pixels that are tested"},
    {.id = StageId::sample_raster,
     .name = "sample_raster",
     .group = raster,
     .color = "#2c8c83",
     .can_be_fixed_function = true,
     .rasterizes = true,
     .counts = items | (kArithmetic & ~(fetch | special)) | kMemory | kRaster,
     .items_in = "setup triangles, counted in each pass",
     .items_out = "cells in which a triangle covers a sample",
     .lanes_used = "covered samples of partly covered cells",
     .lanes_issued = "all samples of partly covered cells"},
    {.id = StageId::reference_raster,
     .name = "reference_raster",
     .group = reference,
     .color = "#bab0ac",
     .rasterizes = true,
     .counts = items | mul_add | add | reads | lanes | empties,
     .items_in = "setup triangles",
     .items_out = "samples at which a triangle is nearer than all earlier ones",
     .lanes_used = "samples that a triangle covers",
     .lanes_issued = "samples that a triangle covers"},
    {.id = StageId::a_buffer,
     .name = "a_buffer",
     .group = fragments,
     .color = "#9c755f",
     .can_be_fixed_function = true,
     .can_be_shader = true,
     .works_by_pixel = true,
     .counts = items | add | kMemory,
     .items_in = "pairs (beam) or fragments (casav)",
     .items_out = "the same items, sorted within each pixel"},
    {.id = StageId::windows,
     .name = "windows",
     .group = fragments,
     .color = "#d7b5a6",
     .can_be_fixed_function = true,
     .can_be_shader = true,
     .works_by_pixel = true,
     .counts = items | add | reads | writes | sectors,
     .items_in = "pairs, from near to far",
     .items_out = "windows"},
    {.id = StageId::beam_fragment,
     .name = "beam_fragment",
     .group = fragments,
     .color = "#f28e2b",
     .can_be_fixed_function = true,
     .can_be_shader = true,
     .counts = items | kArithmetic | wide | kMemory | positions | lanes,
     .items_in = "pairs",
     .items_out = "fragments: pairs whose covered area is not 0",
     .lanes_used = "fragments",
     .lanes_issued = "pairs"},
    {.id = StageId::alpha_mask,
     .name = "alpha_mask",
     .group = fragments,
     .color = "#ffbe7d",
     .can_be_shader = true,
     .counts = items | kArithmetic | kMemory | texels | lanes,
     .items_in = "fragments of cutouts and of translucent triangles",
     .items_out = "those of which something is left",
     .lanes_used = "positions at which alpha is tested or ranked",
     .lanes_issued = "the same positions"},
    {.id = StageId::compose,
     .name = "compose",
     .group = visibility,
     .color = "#e15759",
     .can_be_fixed_function = true,
     .can_be_shader = true,
     .works_by_pixel = true,
     .counts = items | kArithmetic | kMemory | positions | lanes,
     .items_in = "fragments",
     .items_out = "aggregates: one per window (beam:order=sorted) or pixel (casav, alpha); fragments that take a "
                  "position (beam, z3)",
     .lanes_used = "positions whose depths are compared (beam:order=sorted); merged fragments (casav, alpha); "
                   "fragments that take a position (beam, z3)",
     .lanes_issued = "positions of all fragments (beam:order=sorted); all fragments (others)"},
    {.id = StageId::alpha_test,
     .name = "alpha_test",
     .group = fragments,
     .color = "#c3d56b",
     .can_be_shader = true,
     .counts = items | kArithmetic | kMemory | texels | lanes,
     .items_in = "fragments of cutouts, counted in each pass",
     .items_out = "those of which a sample is left",
     .lanes_used = "fragments of cutouts, or their samples (alpha=sample)",
     .lanes_issued = "four invocations for each of their quads, or for each sample that a quad has"},
    {.id = StageId::depth_test,
     .name = "depth_test",
     .group = visibility,
     .color = "#59a14f",
     .can_be_fixed_function = true,
     .works_by_pixel = true,
     .counts = items | mul_add | add | convert | kMemory | lanes,
     .items_in = "samples that are tested, counted in each pass",
     .items_out = "samples that pass",
     .lanes_used = "samples that are tested",
     .lanes_issued = "all samples of the fragments' cells"},
    {.id = StageId::blend,
     .name = "blend",
     .group = visibility,
     .color = "#8cd17d",
     .can_be_fixed_function = true,
     .works_by_pixel = true,
     .counts = items | mul_add | add | convert | kMemory | lanes,
     .items_in = "samples of translucent fragments",
     .items_out = "samples that pass the depth test",
     .lanes_used = "samples that are tested",
     .lanes_issued = "all samples of the fragments' cells"},
    {.id = StageId::stencil_test,
     .name = "stencil_test",
     .group = visibility,
     .color = "#2e6b2a",
     .can_be_fixed_function = true,
     .works_by_pixel = true,
     .counts = items | add | kMemory | lanes,
     .items_in = "samples that are tested",
     .items_out = "samples that pass",
     .lanes_used = "samples that are tested",
     .lanes_issued = "samples that are tested"},
    {.id = StageId::accumulate,
     .name = "accumulate",
     .group = visibility,
     .color = "#b07aa1",
     .can_be_fixed_function = true,
     .works_by_pixel = true,
     .counts = items | (kArithmetic & ~(fetch | special)) | kMemory | lanes,
     .items_in = "fragments with visible samples",
     .items_out = "the same fragments, added to their pixels",
     .lanes_used = "the fragments",
     .lanes_issued = "the fragments"},
    {.id = StageId::sample_select,
     .name = "sample_select",
     .group = shading,
     .color = "#d4a6c8",
     .can_be_shader = true,
     .counts = items | (kArithmetic & ~(fetch | convert)) | kMemory | lanes,
     .items_in = "visibility samples",
     .items_out = "shading samples",
     .lanes_used = "shading samples that show a triangle",
     .lanes_issued = "four shading samples per quad"},
    {.id = StageId::material_sort,
     .name = "material_sort",
     .group = shading,
     .color = "#6b4c86",
     .can_be_shader = true,
     .counts = items | add | bit | fetch | kMemory | lanes,
     .items_in = "shading samples",
     .items_out = "those that show a triangle, material by material",
     .lanes_used = "samples that show a triangle",
     .lanes_issued = "samples"},
    {.id = StageId::shade,
     .name = "shade",
     .group = shading,
     .color = "#edc948",
     .can_be_shader = true,
     .counts = items | kArithmetic | wide | kMemory | texels | lanes,
     .items_in = "fragments, or shading samples",
     .items_out = "the same items, with a colour or a material",
     .lanes_used = "the items",
     .lanes_issued = "the pixels of the items' 2x2 quads; the items alone if shading follows a visibility test"},
    {.id = StageId::light,
     .name = "light",
     .group = shading,
     .color = "#b8970b",
     .can_be_shader = true,
     .counts = items | mul_add | add | special | kMemory | lanes,
     .items_in = "pixels with a material",
     .items_out = "the same pixels, with a colour",
     .lanes_used = "the pixels",
     .lanes_issued = "the pixels"},
    {.id = StageId::motion,
     .name = "motion",
     .group = picture,
     .color = "#ff9da7",
     .can_be_shader = true,
     .works_by_pixel = true,
     .counts = items | kArithmetic | kMemory | lanes,
     .items_in = "samples",
     .items_out = "motion vectors, one per pixel",
     .lanes_used = "pixels",
     .lanes_issued = "pixels"},
    {.id = StageId::dilate,
     .name = "dilate",
     .group = picture,
     .color = "#d37295",
     .can_be_shader = true,
     .works_by_pixel = true,
     .counts = items | (kArithmetic & ~fetch) | kMemory | lanes,
     .items_in = "pixels",
     .items_out = "pixels with a colour",
     .lanes_used = "pixels with at least one visibility sample that has a colour",
     .lanes_issued = "pixels"},
    {.id = StageId::temporal,
     .name = "temporal",
     .group = picture,
     .color = "#5f6fd0",
     .can_be_shader = true,
     .works_by_pixel = true,
     .counts = items | (kArithmetic & ~(bit | fetch)) | kMemory | lanes,
     .items_in = "pixels",
     .items_out = "pixels",
     .lanes_used = "pixels with a history",
     .lanes_issued = "pixels"},
    {.id = StageId::resolve,
     .name = "resolve",
     .group = picture,
     .color = "#79706e",
     .can_be_fixed_function = true,
     .can_be_shader = true,
     .works_by_pixel = true,
     .counts = items | (kArithmetic & ~(bit | fetch)) | kMemory | lanes,
     .items_in = "samples, aggregates or accumulators",
     .items_out = "pixels of the picture",
     .lanes_used = "what comes in",
     .lanes_issued = "what comes in"},
}};

constexpr bool in_order() {
  for (std::size_t i = 0; i < kStageCount; ++i)
    if (static_cast<std::size_t>(kStages[i].id) != i) return false;
  return true;
}
static_assert(in_order());

constexpr std::string_view kPrepass = "prepass_";

}  // namespace

std::string_view name_of(StageGroup group) {
  constexpr std::string_view kNames[] = {"geometry", "raster",  "fragments", "visibility",
                                         "shading",  "picture", "reference"};
  return kNames[static_cast<std::size_t>(group)];
}

std::span<const StageInfo, kStageCount> stage_list() { return kStages; }

std::string_view name_of(Stage stage) {
  static const std::array<std::string, kStageCount> prepass_names = [] {
    std::array<std::string, kStageCount> names;
    for (std::size_t i = 0; i < kStageCount; ++i) names[i].append(kPrepass).append(kStages[i].name);
    return names;
  }();
  if (stage.id == StageId::none) return {};
  if (stage.pass == Pass::prepass) return prepass_names[static_cast<std::size_t>(stage.id)];
  return info_of(stage.id).name;
}

std::ostream& operator<<(std::ostream& stream, Stage stage) { return stream << name_of(stage); }

std::optional<Stage> find_stage(std::string_view name) {
  const Pass pass = name.starts_with(kPrepass) ? Pass::prepass : Pass::main;
  if (pass == Pass::prepass) name.remove_prefix(kPrepass.size());
  const auto found = std::find_if(kStages.begin(), kStages.end(), [&](const StageInfo& s) { return s.name == name; });
  if (found == kStages.end()) return {};
  return Stage(found->id, pass);
}

}  // namespace beampipe
