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

// Stages have Tableau's colours (stages/cost/stage.cpp), so techniques have others: those of Okabe and Ito, "Color
// Universal Design" (2008), without black, and three more. Lighter ones follow.
constexpr std::array kColors = {"#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00",
                                "#56b4e9", "#6a3d9a", "#8b4513", "#c2b800", "#5c6b73"};

// Paul Tol's "muted" scheme (2021).
constexpr std::array<const char*, kErrorCauses.size()> kCauseColors = {"#cc6677", "#332288", "#ddcc77", "#117733",
                                                                       "#88ccee", "#882255", "#999933"};

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

std::string color_at(std::size_t index) {
  const std::string color = kColors[index % kColors.size()];
  return index / kColors.size() % 2 == 0 ? color : lighter(color);
}

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
  return found == kErrorCauses.end() ? kUnknown : kCauseColors[static_cast<std::size_t>(found - kErrorCauses.begin())];
}

}  // namespace beampipe
