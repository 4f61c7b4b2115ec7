// The beam in streaming order: fragments in primitive order, no A-buffer, no memory per fragment. The pixel's state
// (stages/data/owner_pixel.h) is all there is; a pixel in which more surfaces are visible than it has layers takes
// further passes over the geometry, each of which settles the nearest of what is left.
#pragma once

#include "pipeline/technique.h"

namespace beampipe {

struct StreamOptions {
  int positions = 128;  // 32, 64, 128 or 256
  int layers = 5;       // 1 or 5
  int passes = 0;       // at most so many; 0: until every pixel is settled
};

FrameResult render_stream(const Trace& trace, const Frame& frame, const StreamOptions& stream, const RunOptions& run);

std::vector<Surface> stream_framebuffer(const StreamOptions& stream);

}  // namespace beampipe
