#include "tools/report/layers.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "stages/cost/counter_registry.h"
#include "tools/files/image_io.h"
#include "tools/report/tables.h"
#include "traces/files/base64.h"
#include "traces/files/image_file.h"
#include "traces/files/input_file.h"

namespace beampipe {
namespace {

double value_of(float value) { return std::isfinite(value) ? static_cast<double>(value) : 0.0; }

std::string png_url(const std::string& png) { return "data:image/png;base64," + to_base64(png); }

// Linear values need more than the 256 levels of a PNG, or differences of good pictures would show nothing but
// rounding.
Json picture_of(const Image& image) {
  constexpr double kLevels = 65535;
  const std::size_t pixels = std::size_t{image.width} * image.height;
  double low = 0, high = 1;
  for (std::size_t i = 0; i < 4 * pixels; ++i) {
    if (i % 4 == 3) continue;
    low = std::min(low, value_of(image.rgba[i]));
    high = std::max(high, value_of(image.rgba[i]));
  }
  std::vector<std::uint8_t> rgb(6 * pixels);
  for (std::size_t i = 0; i < pixels; ++i)
    for (std::size_t c = 0; c < 3; ++c) {
      const double part = (value_of(image.rgba[4 * i + c]) - low) / (high - low);
      const auto q = static_cast<std::uint32_t>(std::lround(kLevels * std::sqrt(part)));
      rgb[3 * i + c] = static_cast<std::uint8_t>(q >> 8);
      rgb[3 * (pixels + i) + c] = static_cast<std::uint8_t>(q & 255);
    }
  return {{"low", low}, {"high", high}, {"png", png_url(encode_png(image.width, 2 * image.height, rgb))}};
}

Json map_of(const std::string& name, const Planes& planes, const std::vector<float>& values) {
  constexpr double kLevels = 65535;
  double low = 0, high = 0;
  bool whole = true;
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
                              path = std::filesystem::weakly_canonical(folder / name, error);
  const bool has_controls = std::any_of(name.begin(), name.end(), [](unsigned char c) { return c < 0x20; });
  if (error || has_controls || name.empty() || !is_inside(path, folder)) {
    throw ReportError((report.folder / "report.json").string() + ": it names " + in_quotes(name) +
                      "; expected a file in its own folder");
  }
  return report.folder / path.lexically_relative(folder);
}

}  // namespace

std::vector<std::size_t> frames_of_page(std::size_t frames, std::uint64_t pixels_of_a_frame, std::size_t shown) {
  const std::size_t room = std::max<std::uint64_t>(1, kMostPagePixels / std::max<std::uint64_t>(1, pixels_of_a_frame));
  std::set<std::size_t> positions = {shown};
  if (room >= frames) {
    for (std::size_t i = 0; i < frames; ++i) positions.insert(i);
  } else {
    for (std::size_t i = 0; room > 1 && i < room - 1; ++i)
      positions.insert(room == 2 ? frames - 1 : i * (frames - 1) / (room - 2));
  }
  return {positions.begin(), positions.end()};
}

Json report_layers(const ReportFile& report, std::size_t position) {
  Json layers = {{"frame", 0}, {"width", 0}, {"height", 0}, {"techniques", Json::array()}};
  std::set<std::string> names;
  for (const Json& result : report.json.at("results").elements()) {
    const Json& frame = result.at("frames").at(position);
    layers["frame"] = frame.at("index");
    const Image image = read_exr(file_of(report, frame.at("image").get<std::string>()));
    layers["width"] = image.width;
    layers["height"] = image.height;
    Json technique = {{"technique", result.at("technique")}, {"picture", picture_of(image)}, {"maps", Json::array()}};
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

Json page_layers(const ReportFile& report, std::size_t shown) {
  const std::vector<Json>& results = report.json.at("results").elements();
  const Json first = report_layers(report, shown);
  const std::uint64_t pixels =
      first.at("width").get<std::uint64_t>() * first.at("height").get<std::uint64_t>() * results.size();
  Json frames = Json::array();
  for (const std::size_t position : frames_of_page(results.front().at("frames").size(), pixels, shown))
    frames.push_back(position == shown ? first : report_layers(report, position));
  return frames;
}

}  // namespace beampipe
