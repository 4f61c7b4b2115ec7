// Rendering a trace in another size.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "traces/trace.h"

namespace beampipe {

inline constexpr std::uint32_t kMostPixels = 16384;  // of a side, as in a trace

// In pixels. One side of 0 is in proportion to the other; 0 x 0 stands for the size that each frame has.
struct PictureSize {
  std::uint32_t width = 0, height = 0;
  bool operator==(const PictureSize&) const = default;
};

// Gives these frames this size; the vertical angle of view stays as it is. Throws std::runtime_error, one line that
// starts with `name`, if a frame neither names its camera nor has the same ratio of width to height, or if it was
// captured.
void resize(Trace& trace, const std::vector<std::size_t>& frames, const PictureSize& wanted, const std::string& name);

}  // namespace beampipe
