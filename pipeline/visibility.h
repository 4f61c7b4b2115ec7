// One sample per pixel, shaded after visibility is known. `deferred`: depth pass, then materials in 2x2 quads into a
// G-buffer, then light. `visibility`: triangle ids and depth, then materials and light per pixel, without quads.
#pragma once

#include "pipeline/technique.h"
#include "simd/sample_pattern.h"

namespace beampipe {

struct VisibilityOptions {
  SamplePattern pattern = standard_pattern(1);
  std::vector<float>* depth = nullptr;  // if not null: filled with the depth of every pixel of the frame
};

FrameResult render_deferred(const Trace& trace, const Frame& frame, const VisibilityOptions& options,
                            const RunOptions& run);
FrameResult render_visibility(const Trace& trace, const Frame& frame, const VisibilityOptions& options,
                              const RunOptions& run);

std::vector<Surface> deferred_framebuffer();
std::vector<Surface> visibility_framebuffer();

}  // namespace beampipe
