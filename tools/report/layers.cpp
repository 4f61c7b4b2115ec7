#include "tools/report/layers.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "stages/cost/counter_registry.h"
#include "tools/files/image_io.h"
#include "tools/report/tables.h"
#include "traces/base64.h"
#include "traces/input_file.h"

namespace beampipe {
namespace {

std::string png_url(const std::string& png) { return "data:image/png;base64," + to_base64(png); }

Json map_of(const std::string& name, const Planes& planes, const std::vector<float>& values) {
  constexpr double kLevels = 65535;
  double low = 0, high = 0;
  bool whole = true;
  const auto value_of = [](float value) { return std::isfinite(value) ? static_cast<double>(value) : 0.0; };
  for (const float value : values) {
    low = std::min(low, value_of(value));
    high = std::max(high, value_of(value));
    whole = whole && value_of(value) == std::floor(value_of(value));
  }
  const double step = whole && high - low <= kLevels ? 1.0 : (high - low) / kLevels;
  std::vector<std::uint8_t> rgb(3 * values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto q = step > 0 ? static_cast<std::uint32_t>(std::lround((value_of(values[i]) - low) / step)) : 0u;
    rgb[3 * i] = static_cast<std::uint8_t>(q >> 8);
    rgb[3 * i + 1] = static_cast<std::uint8_t>(q & 255);
  }
  return {{"name", name},
          {"low", low},
          {"step", step},
          {"high", high},
          {"png", png_url(encode_png(planes.width, planes.height, rgb))}};
}

// The counters with their definitions: first those of errors, then the others in the order of the registry, then
// unknown ones.
Json kinds_of(const std::set<std::string>& names) {
  Json kinds = Json::array();
  for (const auto* counters : {&error_counters(), &pixel_counters()})
    for (const PixelCounterInfo& counter : *counters)
      if (names.contains(counter.name))
        kinds.push_back({{"name", counter.name}, {"unit", counter.unit}, {"definition", sentence(counter.meaning)}});
  for (const std::string& name : names)
    if (std::none_of(kinds.elements().begin(), kinds.elements().end(),
                     [&](const Json& kind) { return kind.at("name") == name; }))
      kinds.push_back({{"name", name}, {"unit", ""}, {"definition", ""}});
  return kinds;
}

// The path of a file that report.json names. It must be inside the report's folder, so that a report from somewhere
// else cannot show other files.
std::filesystem::path file_of(const ReportFile& report, const std::string& name) {
  // Symbolic links are followed first.
  std::error_code error;
  const std::filesystem::path folder = std::filesystem::weakly_canonical(report.folder),
                              path = std::filesystem::weakly_canonical(folder / name, error).lexically_relative(folder);
  const bool has_controls = std::any_of(name.begin(), name.end(), [](unsigned char c) { return c < 0x20; });
  if (error || has_controls || name.empty() || path.empty() || *path.begin() == "..") {
    throw ReportError((report.folder / "report.json").string() + ": it names " + in_quotes(name) +
                      "; expected a file in its own folder");
  }
  return report.folder / path;
}

}  // namespace

Json report_layers(const ReportFile& report, std::size_t position) {
  Json layers = {{"frame", 0}, {"techniques", Json::array()}};
  std::set<std::string> names;
  for (const Json& result : report.json.at("results").elements()) {
    const Json& frame = result.at("frames").at(position);
    layers["frame"] = frame.at("index");
    const std::filesystem::path picture = file_of(report, frame.at("picture").get<std::string>());
    Json technique = {{"technique", result.at("technique")},
                      {"picture", png_url(read_input_file(picture, picture.string()))},
                      {"maps", Json::array()}};
    if (const Json* counters = frame.find("counters")) {
      const Planes planes = read_exr_planes(file_of(report, counters->get<std::string>()));
      for (const auto& [name, values] : planes.channels) {
        technique["maps"].push_back(map_of(name, planes, values));
        names.insert(name);
      }
    }
    layers["techniques"].push_back(std::move(technique));
  }
  layers["kinds"] = kinds_of(names);
  return layers;
}

}  // namespace beampipe
