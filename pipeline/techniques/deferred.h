// Deferred shading with one sample per pixel: a depth pass, then materials in 2x2 quads into a G-buffer, then light.
#pragma once

#include "pipeline/technique.h"

namespace beampipe {

FrameResult render_deferred(const Trace& trace, const Frame& frame, const RunOptions& run);

std::vector<Surface> deferred_framebuffer();

}  // namespace beampipe
