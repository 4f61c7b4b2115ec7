#include "stages/cost/stage.h"

#include <algorithm>
#include <array>
#include <ostream>
#include <string>

namespace beampipe {
namespace {

using namespace counter_group;
using enum StageGroup;

constexpr bool kYes = true, kNo = false;
constexpr CounterGroups kMemory = reads | writes | sectors | outer_memory;
constexpr CounterGroups kArithmetic = mul_add | add | bit | fetch | special | convert;
constexpr CounterGroups kRaster = hidden | empties | lanes | wide;

// Blue stands for geometry and bins, teal for rasters, orange for fragments, yellow for shading, brown for the
// A-buffer, red for composition, green for samples, purple for sample selection.
constexpr std::array<StageInfo, kStageCount> kStages = {{
    {StageId::vertex_setup, "vertex_setup", geometry, "#4e79a7", kYes, kYes,
     items | (kArithmetic & ~fetch) | wide | kMemory, "triangles of the draws, counted in each pass",
     "setup triangles, counted in each pass"},
    {StageId::bin_sort, "bin_sort", raster, "#a0cbe8", kYes, kYes, items | (kArithmetic & ~special) | kMemory,
     "triangles of the bins' lists", "the same triangles, near to far"},
    {StageId::conservative_raster, "conservative_raster", raster, "#76b7b2", kYes, kNo,
     items | (kArithmetic & ~(fetch | special)) | kMemory | kRaster, "setup triangles", "pairs that may be visible",
     "pixels that a triangle touches", "pixels that are tested"},
    {StageId::sample_raster, "sample_raster", raster, "#2c8c83", kYes, kNo,
     items | (kArithmetic & ~(fetch | special)) | kMemory | kRaster, "setup triangles, counted in each pass",
     "cells in which a triangle covers a sample", "covered samples of partly covered cells",
     "all samples of partly covered cells"},
    {StageId::reference_raster, "reference_raster", reference, "#bab0ac", kNo, kNo,
     items | mul_add | add | reads | lanes | empties, "setup triangles",
     "samples at which a triangle is nearer than all earlier ones", "samples that a triangle covers",
     "samples that a triangle covers"},
    {StageId::a_buffer, "a_buffer", fragments, "#9c755f", kYes, kYes, items | add | kMemory,
     "pairs (beam) or fragments (casav)", "the same items, sorted within each pixel"},
    {StageId::windows, "windows", fragments, "#d7b5a6", kYes, kYes, items | add | reads | writes | sectors,
     "pairs, from near to far", "windows"},
    {StageId::beam_fragment, "beam_fragment", fragments, "#f28e2b", kYes, kYes,
     items | kArithmetic | wide | kMemory | positions | lanes, "pairs", "fragments: pairs whose covered area is not 0",
     "fragments", "pairs"},
    {StageId::alpha_mask, "alpha_mask", fragments, "#ffbe7d", kNo, kYes, items | kArithmetic | kMemory | texels | lanes,
     "fragments of cutouts and of translucent triangles", "those of which something is left",
     "positions at which alpha is tested or ranked", "the same positions"},
    {StageId::compose, "compose", visibility, "#e15759", kYes, kYes, items | kArithmetic | kMemory | positions | lanes,
     "fragments",
     "aggregates: one per window (beam:order=sorted) or pixel (casav, alpha); fragments that take a position (beam, "
     "z3)",
     "positions whose depths are compared (beam:order=sorted); merged fragments (casav, alpha); fragments that take a "
     "position (beam, z3)",
     "positions of all fragments (beam:order=sorted); all fragments (others)"},
    {StageId::alpha_test, "alpha_test", fragments, "#c3d56b", kNo, kYes, items | kArithmetic | kMemory | texels | lanes,
     "fragments of cutouts, counted in each pass", "those of which a sample is left",
     "fragments of cutouts, or their samples (alpha=sample)",
     "four invocations for each of their quads, or for each sample that a quad has"},
    {StageId::depth_test, "depth_test", visibility, "#59a14f", kYes, kNo,
     items | mul_add | add | convert | kMemory | lanes, "samples that are tested, counted in each pass",
     "samples that pass", "samples that are tested", "all samples of the fragments' cells"},
    {StageId::blend, "blend", visibility, "#8cd17d", kYes, kNo, items | mul_add | add | convert | kMemory | lanes,
     "samples of translucent fragments", "samples that pass the depth test", "samples that are tested",
     "all samples of the fragments' cells"},
    {StageId::stencil_test, "stencil_test", visibility, "#2e6b2a", kYes, kNo, items | add | kMemory | lanes,
     "samples that are tested", "samples that pass", "samples that are tested", "samples that are tested"},
    {StageId::accumulate, "accumulate", visibility, "#b07aa1", kYes, kNo,
     items | (kArithmetic & ~(fetch | special)) | kMemory | lanes, "fragments with visible samples",
     "the same fragments, added to their pixels", "the fragments", "the fragments"},
    {StageId::sample_select, "sample_select", shading, "#d4a6c8", kNo, kYes,
     items | (kArithmetic & ~(fetch | convert)) | kMemory | lanes, "visibility samples", "shading samples",
     "shading samples that show a triangle", "four shading samples per quad"},
    {StageId::material_sort, "material_sort", shading, "#6b4c86", kNo, kYes,
     items | add | bit | fetch | kMemory | lanes, "shading samples", "those that show a triangle, material by material",
     "samples that show a triangle", "samples"},
    {StageId::shade, "shade", shading, "#edc948", kNo, kYes, items | kArithmetic | wide | kMemory | texels | lanes,
     "fragments, or shading samples", "the same items, with a colour or a material", "the items",
     "the pixels of the items' 2x2 quads; the items alone if shading follows a visibility test"},
    {StageId::light, "light", shading, "#b8970b", kNo, kYes, items | mul_add | add | special | kMemory | lanes,
     "pixels with a material", "the same pixels, with a colour", "the pixels", "the pixels"},
    {StageId::motion, "motion", picture, "#ff9da7", kNo, kYes, items | kArithmetic | kMemory | lanes, "samples",
     "motion vectors, one per pixel", "pixels", "pixels"},
    {StageId::dilate, "dilate", picture, "#d37295", kNo, kYes, items | (kArithmetic & ~fetch) | kMemory | lanes,
     "pixels", "pixels with a colour", "pixels with at least one visibility sample that has a colour", "pixels"},
    {StageId::temporal, "temporal", picture, "#5f6fd0", kNo, kYes,
     items | (kArithmetic & ~(bit | fetch)) | kMemory | lanes, "pixels", "pixels", "pixels with a history", "pixels"},
    {StageId::resolve, "resolve", picture, "#79706e", kYes, kYes,
     items | (kArithmetic & ~(bit | fetch)) | kMemory | lanes, "samples, aggregates or accumulators",
     "pixels of the picture", "what comes in", "what comes in"},
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
