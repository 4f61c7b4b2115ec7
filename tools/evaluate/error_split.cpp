#include "tools/evaluate/error_split.h"

#include <algorithm>
#include <cmath>

#include "stages/geometry/vertex_setup.h"

namespace beampipe {
namespace {

constexpr SurfaceColors kColors = SurfaceColors::by_pixel;

double root_mean_square(const std::vector<float>& values) {
  double squares = 0;
  for (const float value : values) squares += double{value} * value;
  return values.empty() ? 0.0 : std::sqrt(squares / static_cast<double>(values.size()));
}

// Of the three values of each pixel.
std::vector<float> root_mean_squares(const std::vector<float>& values) {
  std::vector<float> pixels(values.size() / 3);
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    double squares = 0;
    for (std::size_t c = 0; c < 3; ++c) squares += double{values[3 * i + c]} * values[3 * i + c];
    pixels[i] = static_cast<float>(std::sqrt(squares / 3.0));
  }
  return pixels;
}

}  // namespace

bool has_varying_surfaces(const RunPlan& plan) {
  return std::any_of(plan.frames.begin(), plan.frames.end(),
                     [&](std::size_t frame) { return has_varying_surfaces(plan.trace, plan.trace.frames.at(frame)); });
}

ErrorParts split_error(const PicturePair& pictures, const PicturePair& by_pixel,
                       std::map<std::string, std::vector<float>>& pixel_counters) {
  std::vector<float> errors = signed_errors(pictures.image, pictures.reference);
  const std::vector<float> visibility = signed_errors(by_pixel.image, by_pixel.reference);
  for (std::size_t i = 0; i < errors.size(); ++i) errors[i] -= visibility[i];
  pixel_counters["visibility_error"] = root_mean_squares(visibility);
  pixel_counters["shading_error"] = root_mean_squares(errors);
  return {root_mean_square(visibility), root_mean_square(errors)};
}

ErrorParts pooled_parts(const FrameReports& frames) {
  ErrorParts squares;
  double pixels = 0;
  for (const FrameReport& frame : frames) {
    const ErrorParts& parts = frame.parts.value();
    const auto frame_pixels = static_cast<double>(frame.pixels);
    squares.visibility += parts.visibility * parts.visibility * frame_pixels;
    squares.shading += parts.shading * parts.shading * frame_pixels;
    pixels += frame_pixels;
  }
  return {std::sqrt(squares.visibility / pixels), std::sqrt(squares.shading / pixels)};
}

ErrorSplit::ErrorSplit(std::size_t techniques, const std::vector<std::uint32_t>& ladder)
    : histories_(techniques), ladder_(ladder, kColors) {}

void ErrorSplit::go_on_after(std::size_t frames, const RunPlan& plan, Progress& progress) {
  histories_ = rebuild_histories(plan, frames, progress, kColors);
}

void ErrorSplit::start_frame(const RunPlan& plan, std::size_t frame, Progress& progress) {
  reference_ = kept_picture(truth_, plan, frame, progress, kColors);
  frame_ = frame;
}

ErrorParts ErrorSplit::split(const RunPlan& plan, std::size_t i, FrameResult& result, const Image& reference,
                             Progress& progress) {
  const Technique& technique = plan.techniques[i];
  image_ = render_picture(technique, plan, frame_, progress, kColors, &histories_[i]);
  measure_named_error(technique.spec, frame_, image_, reference_);  // throws if a value is not finite
  return split_error({result.image, reference}, pictures(), result.pixel_counters);
}

void ErrorSplit::add_rungs(const RunPlan& plan, Progress& progress) { ladder_.add(plan, frame_, reference_, progress); }

std::vector<LadderRung> ErrorSplit::rungs(const RunPlan& plan, const std::vector<double>& rmses, Progress& progress) {
  const auto read_reference = [&](std::size_t frame) {
    if (reference_.rgba.empty() || frame != frame_) start_frame(plan, frame, progress);
    return reference_;
  };
  std::vector<MetricErrors> errors;
  for (const double rmse : rmses) errors.push_back({rmse, rmse});
  return ladder_.rungs(plan, errors, read_reference, progress).rmse;
}

}  // namespace beampipe
