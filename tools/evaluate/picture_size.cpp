#include "tools/evaluate/picture_size.h"

#include <algorithm>
#include <stdexcept>

namespace beampipe {
namespace {

std::string text_of(const PictureSize& size) {
  return std::to_string(size.width) + " x " + std::to_string(size.height);
}

bool has_viewport(const Frame& frame) {
  return std::any_of(frame.draws.begin(), frame.draws.end(),
                     [](const Draw& draw) { return draw.state.viewport || draw.state.scissor; });
}

}  // namespace

void resize(Trace& trace, const std::vector<std::size_t>& frames, const PictureSize& size, const std::string& name) {
  if (size == PictureSize{}) return;
  for (const std::size_t index : frames) {
    Frame& frame = trace.frames[index];
    const bool same_ratio = std::uint64_t{frame.width} * size.height == std::uint64_t{frame.height} * size.width;
    if (trace.source || has_viewport(frame) || (!frame.camera && !same_ratio))
      throw std::runtime_error(name + ": cannot be " + text_of(size) +
                               " pixels: expected frames that name a camera, or have this ratio of width to height, "
                               "without viewports and not captured");
    frame.width = size.width, frame.height = size.height;
    if (frame.camera) set_camera(frame, Camera(*frame.camera));
  }
}

}  // namespace beampipe
