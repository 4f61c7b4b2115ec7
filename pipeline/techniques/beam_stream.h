// The beam in streaming order: fragments come in primitive order, without an A-buffer or any memory per fragment. A
// pixel keeps only its state (stages/data/owner_pixel.h). A pixel that shows more surfaces than it has layers takes
// further passes over the geometry; each pass settles the nearest surfaces that are left.
#pragma once

#include "pipeline/technique.h"

namespace beampipe {

struct StreamOptions {
  int positions = 128;  // 32, 64, 128 or 256
  int layers = 5;       // 1 or 5
  int passes = 0;       // the most passes; 0: until every pixel is settled
};

FrameResult render_stream(const Trace& trace, const Frame& frame, const StreamOptions& stream, const RunOptions& run);

std::vector<Surface> stream_framebuffer(const StreamOptions& stream);

}  // namespace beampipe
