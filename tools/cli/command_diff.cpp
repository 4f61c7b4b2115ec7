// beampipe diff: measures the error of one picture against another.

#include <cstdio>
#include <iostream>
#include <memory>

#include "tools/cli/commands.h"
#include "tools/evaluate/frame_json.h"
#include "tools/evaluate/metrics.h"
#include "tools/files/image_io.h"

namespace beampipe {
namespace {

struct DiffArguments {
  std::string a, b;
  bool json = false;
};

// The number of pixels in which R, G or B differ.
std::uint64_t differing_pixels(const Image& a, const Image& b) {
  std::uint64_t differing = 0;
  for (std::size_t i = 0; i < a.rgba.size(); i += 4) {
    differing += a.rgba[i] != b.rgba[i] || a.rgba[i + 1] != b.rgba[i + 1] || a.rgba[i + 2] != b.rgba[i + 2];
  }
  return differing;
}

void diff(const DiffArguments& arguments) {
  const Image a = read_exr(arguments.a);
  const Image b = read_exr(arguments.b);
  ErrorStats stats;
  try {
    stats = measure_error(a, b);
  } catch (const std::exception& error) {
    throw std::runtime_error(arguments.a + " and " + arguments.b + ": " + error.what());
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
  char text[256];
  std::snprintf(text, sizeof text,
                "%u x %u, of which %llu pixels differ\nrmse  %.9g\nbias  %+.9g\np99   %.9g\nmax   %.9g\n", a.width,
                a.height, static_cast<unsigned long long>(differing), stats.rmse, stats.bias, stats.p99, stats.max);
  std::cout << text;
}

}  // namespace

void add_diff_command(CommandLine& line) {
  const auto arguments = std::make_shared<DiffArguments>();
  Command command = line.add_command("diff", "Measure how far picture A is from picture B");
  command.add("A", arguments->a, "an EXR image").required();
  command.add("B", arguments->b, "the correct image, an EXR file of the same size").required();
  command.add_flag("--json", arguments->json, "print the result as JSON");
  command.footer(
      "Compares linear R, G and B. Prints the number of pixels that differ, the root mean square error (rmse), the "
      "mean\n"
      "of A - B (bias), the 99th percentile of the absolute errors (p99) and the largest error (max). The exit code is "
      "0\n"
      "even if the pictures differ.");
  command.set_work([arguments] { diff(*arguments); });
}

}  // namespace beampipe
