// The truth: 4096 samples per pixel in double precision, on the same snapped triangles as every technique.
#pragma once

#include "pipeline/technique.h"

namespace beampipe {

FrameResult render_reference(const Trace& trace, const Frame& frame, const RunOptions& run);

std::vector<Surface> reference_framebuffer();

}  // namespace beampipe
