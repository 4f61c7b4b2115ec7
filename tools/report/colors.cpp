#include "tools/report/colors.h"

#include <algorithm>
#include <array>
#include <iomanip>
#include <optional>
#include <sstream>

#include "pipeline/error_causes.h"
#include "stages/cost/stage.h"
#include "tools/evaluate/known_specs.h"

namespace beampipe {
namespace {

// Tableau's ten colours, which most people can tell apart, then lighter versions of them.
constexpr std::array kColors = {"#4e79a7", "#f28e2b", "#e15759", "#76b7b2", "#59a14f", "#edc948", "#b07aa1",
                                "#9c755f", "#ff9da7", "#79706e", "#a0cbe8", "#ffbe7d", "#ffb6b4", "#a8dcd9",
                                "#8cd17d", "#f7e5a1", "#d4a6c8", "#d7b5a6", "#fcd9de", "#bab0ac"};

constexpr const char* kUnknown = "#888888";

// Half way to white. `color`: "#rrggbb".
std::string lighter(const std::string& color) {
  std::ostringstream text;
  text << '#' << std::hex << std::setfill('0');
  for (const std::size_t at : {1, 3, 5})
    text << std::setw(2) << (std::stoul(color.substr(at, 2), nullptr, 16) + 255) / 2;
  return text.str();
}

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

std::string stage_color(std::string_view name) {
  const std::optional<Stage> stage = find_stage(name);
  if (!stage) return kUnknown;
  const std::string color(info_of(stage->id).color);
  return stage->pass == Pass::prepass ? lighter(color) : color;
}

std::string cause_color(std::string_view cause) {
  const auto* const found = std::find(kErrorCauses.begin(), kErrorCauses.end(), cause);
  return found == kErrorCauses.end() ? kUnknown : color_at(static_cast<std::size_t>(found - kErrorCauses.begin()) + 1);
}

}  // namespace beampipe
