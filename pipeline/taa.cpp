#include "pipeline/taa.h"

#include "pipeline/tiles.h"
#include "pipeline/visibility.h"

namespace beampipe {
namespace {

// Sampling at another position of the pixel is what jittering the projection comes to.
SamplePattern jittered(const TaaOptions& options, std::uint32_t frame) {
  const SamplePattern all = standard_pattern(options.samples);
  const std::size_t i = frame % static_cast<std::uint32_t>(options.samples);
  SamplePattern one;
  one.count = 1;
  one.x[0] = all.x[i], one.y[0] = all.y[i];
  return one;
}

}  // namespace

FrameResult render_taa(const Trace& trace, const Frame& frame, const TaaOptions& options, const RunOptions& run) {
  History first;
  History& history = run.history ? *run.history : first;
  CurrentFrame current(frame.width, frame.height);
  current.view_projection = frame.projection * frame.view;
  FrameResult result = render_visibility(trace, frame, {jittered(options, history.frames), &current.depth}, run);
  current.color = pixels_of(result.image);

  StageCounters accumulation{"temporal"};
  neighborhood_box(current, accumulation);
  result.image = image_of(frame, temporal(current, {options.blend}, accumulation, history));
  result.stages.push_back(accumulation);
  return result;
}

std::vector<Surface> taa_framebuffer() {
  std::vector<Surface> surfaces = visibility_framebuffer();
  surfaces.push_back({"history", "RGBA16F x 2", 16});  // the last one, and the one being written
  return surfaces;
}

}  // namespace beampipe
