#include "tools/cli/record_inspections.h"

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <map>

#include "tools/cli/command_line.h"
#include "tools/evaluate/known_specs.h"
#include "tools/evaluate/metrics.h"
#include "tools/files/image_io.h"
#include "tools/inspect/recorded.h"

namespace beampipe {
namespace {

struct FramePixel {
  float error;
  std::size_t frame;
  PixelAddress at;
};

// The pixels with the largest errors, of all frames.
std::vector<FramePixel> worst_of(const TechniqueReport& result, const TechniqueReport& reference, std::size_t count,
                                 const OutputFolder& output) {
  std::vector<FramePixel> worst;
  for (std::size_t i = 0; i < result.frames.size() && count > 0; ++i) {
    const Image image = read_exr(output.path() / result.frames[i].image);
    const Image truth = read_exr(output.path() / reference.frames[i].image);
    const std::vector<float> errors = pixel_errors(image, truth);
    for (const PixelAddress& at : worst_pixels(image, truth, count))
      worst.push_back({errors[std::size_t{at.y} * image.width + at.x], result.frames[i].index, at});
  }
  std::stable_sort(worst.begin(), worst.end(),
                   [](const FramePixel& a, const FramePixel& b) { return a.error > b.error; });
  worst.resize(std::min(count, worst.size()));
  return worst;
}

}  // namespace

PixelAddress parse_pixel(const std::string& option, const std::string& text, const Frame& frame) {
  PixelAddress pixel{};
  const char* const end = text.data() + text.size();
  auto parsed = std::from_chars(text.data(), end, pixel.x);
  const bool has_comma = parsed.ec == std::errc() && parsed.ptr != end && *parsed.ptr == ',';
  if (has_comma) parsed = std::from_chars(parsed.ptr + 1, end, pixel.y);
  if (!has_comma || parsed.ec != std::errc() || parsed.ptr != end || pixel.x >= frame.width || pixel.y >= frame.height)
    throw UsageError(option + " " + text + ": expected X,Y with X from 0 to " + std::to_string(frame.width - 1) +
                     " and Y from 0 to " + std::to_string(frame.height - 1));
  return pixel;
}

void record_inspections(const RunPlan& plan, const RecordedPixels& pixels, Report& report, OutputFolder& output) {
  const std::string trace = std::filesystem::path(plan.trace_file).filename().string();
  for (const Technique& technique : plan.techniques) {
    const auto of_spec = [&](const std::string& spec) {
      return std::find_if(report.results.begin(), report.results.end(),
                          [&](const TechniqueReport& each) { return each.technique == spec; });
    };
    const auto result = of_spec(technique.spec), reference = of_spec(kReferenceSpec);
    if (!technique.is_observable) continue;
    std::map<std::size_t, std::vector<PixelAddress>> of_frames;
    for (const FramePixel& each : worst_of(*result, *reference, pixels.worst, output))
      of_frames[each.frame].push_back(each.at);
    for (const std::size_t frame : plan.frames)
      for (const std::string& text : pixels.chosen) {
        std::vector<PixelAddress>& of_frame = of_frames[frame];
        const PixelAddress at = parse_pixel("--inspect", text, plan.trace.frames[frame]);
        if (std::find(of_frame.begin(), of_frame.end(), at) == of_frame.end()) of_frame.push_back(at);
      }
    std::vector<PixelInspection> inspections;
    for (const auto& [frame, at] : of_frames)
      for (PixelInspection& each : inspect(plan.trace, frame, technique, at, plan.options))
        inspections.push_back(std::move(each));
    if (inspections.empty()) continue;
    result->inspections = spec_folder(technique.spec) + "/" + kInspectionsFile;
    output.write(result->inspections, recorded_inspections(inspections, trace).dump() + "\n");
  }
}

}  // namespace beampipe
