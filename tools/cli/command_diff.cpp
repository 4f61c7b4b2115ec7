// beampipe diff: measures the error of one picture against another.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <memory>

#include "tools/cli/commands.h"
#include "tools/cli/metric_options.h"
#include "tools/evaluate/frame_json.h"
#include "tools/evaluate/measures.h"
#include "tools/files/format.h"
#include "tools/files/image_io.h"
#include "tools/files/output.h"
#include "traces/files/image_file.h"

namespace beampipe {
namespace {

struct DiffArguments {
  std::string a, b;
  bool json = false;
  std::string map, metric = "flip";
  double pixels_per_degree = kPixelsPerDegree;
};

// The number of pixels in which R, G or B differ.
std::uint64_t differing_pixels(const Image& a, const Image& b) {
  std::uint64_t differing = 0;
  for (std::size_t i = 0; i < a.rgba.size(); i += 4) {
    differing += a.rgba[i] != b.rgba[i] || a.rgba[i + 1] != b.rgba[i + 1] || a.rgba[i + 2] != b.rgba[i + 2];
  }
  return differing;
}

// The bytes of a map as a file of this name: EXR has the numbers, PNG shows 0 in black and 1 in white.
std::string map_bytes(const DiffArguments& arguments, const Image& a, const Image& b) {
  const std::vector<float> map = find_metric(arguments.metric).map(a, b, arguments.pixels_per_degree);
  if (arguments.map.ends_with(".exr")) return encode_exr(Planes{a.width, a.height, {{arguments.metric, map}}});
  std::vector<std::uint8_t> rgb;
  for (const float value : map)
    rgb.insert(rgb.end(), 3, static_cast<std::uint8_t>(std::lround(255 * std::clamp(value, 0.0f, 1.0f))));
  return encode_png(a.width, a.height, rgb);
}

void diff(const DiffArguments& arguments, InterruptGate& gate) {
  check_pixels_per_degree(arguments.pixels_per_degree);
  if (!arguments.map.empty()) {
    if (!arguments.map.ends_with(".exr") && !arguments.map.ends_with(".png"))
      throw UsageError("--map: expected a name that ends in .exr or .png, found " + arguments.map);
    require_writable_file(std::filesystem::absolute(arguments.map));
  }
  const Image a = read_exr(arguments.a);
  const Image b = read_exr(arguments.b);
  ErrorStats stats;
  try {
    stats = measure_all(a, b, arguments.pixels_per_degree);
  } catch (const std::exception& error) {
    throw std::runtime_error(arguments.a + " and " + arguments.b + ": " + error.what());
  }
  if (!arguments.map.empty()) {
    const std::filesystem::path file = std::filesystem::absolute(arguments.map);
    OutputFolder output(file.parent_path(), gate);
    output.write(file.filename(), map_bytes(arguments, a, b));
    output.keep();
  }
  const std::uint64_t differing = differing_pixels(a, b);
  if (arguments.json) {
    Json json = {{"beampipe_diff", 1}, {"a", arguments.a}, {"b", arguments.b}};
    json["width"] = a.width;
    json["height"] = a.height;
    const Json errors = error_form().write(stats);
    for (const auto& [key, value] : errors.members()) json[key] = value;
    json["differing_pixels"] = differing;
    std::cout << json_text(json);
    return;
  }
  std::cout << format("%u x %u, of which %llu pixels differ\n", a.width, a.height,
                      static_cast<unsigned long long>(differing));
  for (const Measure& measure : measures()) {
    const std::optional<double> value = measure.value(stats);
    const std::string number = value ? format(measure.key == std::string("bias") ? "%+.9g" : "%.9g", *value) : "none";
    std::cout << format("%-9s  %s\n", measure.key, number.c_str());
  }
}

}  // namespace

void add_diff_command(CommandLine& line, InterruptGate& gate) {
  const auto arguments = std::make_shared<DiffArguments>();
  Command command = line.add_command("diff", "Measure how far picture A is from picture B");
  command.add("A", arguments->a, "an EXR image").required();
  command.add("B", arguments->b, "the correct image, an EXR file of the same size").required();
  command.add_flag("--json", arguments->json, "print the result as JSON");
  const Option map =
      command.add("--map", arguments->map, "write a value for each pixel into FILE.exr, or a grey FILE.png");
  command.add("--metric", arguments->metric, "what the map shows").one_of(map_names()).shows_default().needs(map);
  add_pixels_per_degree(command, arguments->pixels_per_degree);
  command.footer(measures_help() + "The exit code is 0 even if the pictures differ.");
  command.set_work([arguments, &gate] { diff(*arguments, gate); });
}

}  // namespace beampipe
