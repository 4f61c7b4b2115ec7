// Accumulative antialiasing (Enderton et al. 2015): a depth-only pass at N samples, then a pass that adds each visible
// fragment's colour, weighted by its visible samples, to one accumulator per pixel. Above 16 samples there are several
// such rounds, each with another part of the samples, on the same surfaces.
#pragma once

#include "pipeline/sampling.h"
#include "pipeline/technique.h"
#include "stages/samples/accumulate.h"

namespace beampipe {

inline constexpr int kMaxAcaaSamples = 256;

// What finds the visible samples of a fragment in the second pass. Pictures do not depend on it.
enum class VisibleSamples {
  // The depth test, which precedes the shader and passes on what is left of the coverage: post-z coverage
  // (VK_EXT_post_depth_coverage), or a blend unit that modulates colours by it (GL_NV_framebuffer_mixed_samples, which
  // NVIDIA's sample BlendedAA uses). The colour target has one sample where depth has N: target-independent raster.
  post_z,
  // The shader, where a raster of N samples over a colour target with one excludes a depth test (Direct3D 11.1,
  // D3D11_RASTERIZER_DESC1::ForcedSampleCount). The pass rasterizes and launches hidden fragments too, and the shader
  // reads depths as a texture. A GPU without target-independent raster needs N colours as well: that is msaa:N.
  shader,
};

struct AcaaOptions {
  int samples = 8;  // a power of two, 1..256
  DoubleCounting double_counting = DoubleCounting::none;
  AccumulatorFormat color = AccumulatorFormat::fp16;
  VisibleSamples visible = VisibleSamples::post_z;  // with DoubleCounting::stencil always so
};

}  // namespace beampipe
