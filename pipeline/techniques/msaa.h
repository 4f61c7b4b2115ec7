// Multisampling: N depth and colour samples per pixel, shading once per triangle and pixel. N to 16 at the standard
// positions; above, super-resolution of 8x multisampling, as the paper made its own comparisons.
#pragma once

#include "pipeline/sampling.h"
#include "pipeline/technique.h"
#include "stages/samples/shading_point.h"

namespace beampipe {

inline constexpr int kMaxMsaaSamples = 1024;

struct MsaaOptions {
  int samples = 1;
  bool rgba = false;  // fp16 RGBA samples in place of RGB: 12 bytes per sample with depth, as the ACAA talk counts
  ShadeAt at = ShadeAt::centre;
  bool prepass = false;  // depth first, so that only what is visible is shaded. The image is the same.
};

FrameResult render_msaa(const Trace& trace, const Frame& frame, const MsaaOptions& options, const RunOptions& run);

std::vector<Surface> msaa_framebuffer(const MsaaOptions& options);

}  // namespace beampipe
