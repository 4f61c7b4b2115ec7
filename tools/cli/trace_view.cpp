#include "tools/cli/trace_view.h"

#include <stdexcept>

#include "tools/cli/camera_file.h"
#include "tools/evaluate/picture_size.h"

namespace beampipe {
namespace {

void apply_camera(const TraceView& view, const std::vector<std::size_t>& frames, const std::string& name,
                  Trace& trace) {
  const CameraWishes wishes = read_camera_file(view.camera);
  for (const std::size_t index : frames)
    if (!trace.frames[index].camera)
      throw std::runtime_error(name + ": frame " + std::to_string(index) +
                               " cannot have another camera: expected a frame that names one, found matrices");
  const Frame& first = trace.frames[frames.front()];
  const Camera camera = frame_model(trace, first.width, first.height, wishes);
  for (const std::size_t index : frames) set_camera(trace.frames[index], camera);
}

}  // namespace

void add_trace_view_options(Command& command, TraceView& view) {
  command
      .add("--width", view.width,
           "the width of the picture in pixels, for traces that name a camera; the vertical angle of view stays "
           "(default: the trace's, or in proportion to --height)")
      .between(1, kMostPixels);
  command.add("--height", view.height, "the height of the picture in pixels, likewise").between(1, kMostPixels);
  command.add("--camera", view.camera, kCameraHelp);
}

void apply(const TraceView& view, const std::vector<std::size_t>& frames, const std::string& name, Trace& trace) {
  try {
    resize(trace, frames, {view.width, view.height}, name);
    if (!view.camera.empty()) apply_camera(view, frames, name, trace);
  } catch (const std::invalid_argument& error) {
    throw UsageError(view.camera + ": " + error.what());
  }
}

}  // namespace beampipe
