// beam, sorted: visibility first. Pairs of pixels and triangles are sorted by depth in an A-buffer; window by window,
// near to far, they become shaded fragments and are composed, until the pixel is closed.
#pragma once

#include "pipeline/technique.h"
#include "stages/data/beam_aggregate.h"

namespace beampipe {

struct BeamOptions {
  int positions = 256;  // of the mask: 32, 64, 128 or 256
  Storage storage = Storage::packed;
};

FrameResult render_beam(const Trace& trace, const Frame& frame, const BeamOptions& beam, const RunOptions& run);

// Technique::weights. Depth is compared position by position, so `order` decides nothing.
std::vector<PixelWeights> beam_weights(const Trace& trace, const Frame& frame, const BeamOptions& beam,
                                       const RunOptions& run);

std::vector<Surface> beam_framebuffer(const BeamOptions& beam);

}  // namespace beampipe
