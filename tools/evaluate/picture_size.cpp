#include "tools/evaluate/picture_size.h"

#include <algorithm>
#include <stdexcept>

#include "traces/size_text.h"

namespace beampipe {
namespace {

bool has_viewport(const Frame& frame) {
  return std::any_of(frame.draws.begin(), frame.draws.end(),
                     [](const Draw& draw) { return draw.state.viewport || draw.state.scissor; });
}

// One side times the ratio of the frame's own, rounded.
std::uint32_t in_proportion(std::uint32_t side, std::uint32_t own, std::uint32_t own_side) {
  const std::uint64_t rounded = (std::uint64_t{2} * side * own + own_side) / (std::uint64_t{2} * own_side);
  return static_cast<std::uint32_t>(std::clamp<std::uint64_t>(rounded, 1, kMostPixels));
}

}  // namespace

void resize(Trace& trace, const std::vector<std::size_t>& frames, const PictureSize& wanted, const std::string& name) {
  if (wanted == PictureSize{}) return;
  for (const std::size_t index : frames) {
    Frame& frame = trace.frames[index];
    const PictureSize size{wanted.width > 0 ? wanted.width : in_proportion(wanted.height, frame.width, frame.height),
                           wanted.height > 0 ? wanted.height : in_proportion(wanted.width, frame.height, frame.width)};
    if (size == PictureSize{frame.width, frame.height}) continue;
    const bool same_ratio = std::uint64_t{frame.width} * size.height == std::uint64_t{frame.height} * size.width;
    if (trace.source)
      throw std::runtime_error(name + ": cannot be " + size_text(size.width, size.height) + " pixels: expected " +
                               size_text(frame.width, frame.height) + ", because the frame was captured so");
    if (has_viewport(frame) || (!frame.camera && !same_ratio))
      throw std::runtime_error(name + ": cannot be " + size_text(size.width, size.height) +
                               " pixels: expected frames that name a camera, or have this ratio of width to height, "
                               "without viewports");
    frame.width = size.width, frame.height = size.height;
    if (frame.camera) set_camera(frame, Camera(*frame.camera));
  }
}

}  // namespace beampipe
