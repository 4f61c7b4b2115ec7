#include "tools/report/colors.h"

#include <algorithm>
#include <array>
#include <iomanip>
#include <sstream>
#include <utility>

#include "pipeline/error_causes.h"

namespace beampipe {
namespace {

// Tableau's ten colours, which most people can tell apart, then lighter versions of them.
constexpr std::array kColors = {"#4e79a7", "#f28e2b", "#e15759", "#76b7b2", "#59a14f", "#edc948", "#b07aa1",
                                "#9c755f", "#ff9da7", "#79706e", "#a0cbe8", "#ffbe7d", "#ffb6b4", "#a8dcd9",
                                "#8cd17d", "#f7e5a1", "#d4a6c8", "#d7b5a6", "#fcd9de", "#bab0ac"};

constexpr const char* kUnknown = "#888888";

// Stages that do similar work have similar hues: blue for geometry and bins, teal for rasters, orange for fragments,
// yellow for shading, brown for the A-buffer, red for composition, green for samples, purple for sample selection.
constexpr std::pair<std::string_view, const char*> kStages[] = {
    {"vertex_setup", "#4e79a7"},  {"bin_sort", "#a0cbe8"},        {"conservative_raster", "#76b7b2"},
    {"sample_raster", "#2c8c83"}, {"beam_fragment", "#f28e2b"},   {"alpha_mask", "#ffbe7d"},
    {"shade", "#edc948"},         {"light", "#b8970b"},           {"a_buffer", "#9c755f"},
    {"windows", "#d7b5a6"},       {"compose", "#e15759"},         {"alpha_test", "#c3d56b"},
    {"depth_test", "#59a14f"},    {"blend", "#8cd17d"},           {"stencil_test", "#2e6b2a"},
    {"accumulate", "#b07aa1"},    {"sample_select", "#d4a6c8"},   {"material_sort", "#6b4c86"},
    {"motion", "#ff9da7"},        {"dilate", "#d37295"},          {"temporal", "#5f6fd0"},
    {"resolve", "#79706e"},       {"reference_raster", "#bab0ac"}};

// Half way to white. `color`: "#rrggbb".
std::string lighter(const std::string& color) {
  std::ostringstream text;
  text << '#' << std::hex << std::setfill('0');
  for (const std::size_t at : {1, 3, 5})
    text << std::setw(2) << (std::stoul(color.substr(at, 2), nullptr, 16) + 255) / 2;
  return text.str();
}

bool is_msaa(std::string_view spec) { return spec == "msaa" || spec.starts_with("msaa:"); }

}  // namespace

std::string color_at(std::size_t index) { return kColors[index % kColors.size()]; }

std::string technique_color(const std::vector<std::string>& specs, std::string_view spec) {
  if (is_msaa(spec)) return color_at(0);
  std::size_t place = 1;
  for (const std::string& each : specs) {
    if (each == spec) return color_at(place);
    place += !is_msaa(each);
  }
  return kUnknown;
}

std::string stage_color(std::string_view stage) {
  constexpr std::string_view kPrepass = "prepass_";
  if (stage.starts_with(kPrepass)) return lighter(stage_color(stage.substr(kPrepass.size())));
  const auto* const found =
      std::find_if(std::begin(kStages), std::end(kStages), [&](const auto& known) { return known.first == stage; });
  return found == std::end(kStages) ? kUnknown : found->second;
}

std::string cause_color(std::string_view cause) {
  const auto* const found = std::find(kErrorCauses.begin(), kErrorCauses.end(), cause);
  return found == kErrorCauses.end() ? kUnknown : color_at(static_cast<std::size_t>(found - kErrorCauses.begin()) + 1);
}

}  // namespace beampipe
