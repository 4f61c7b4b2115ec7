// Multisampling: N depth and colour samples per pixel, shaded once per triangle and pixel. Up to 16 samples are at the
// standard positions. Above, the picture is super-resolved 8x multisampling, as in the comparisons of Crassin et al.
//
// Without `prepass`, shading is charged before the depth test (late Z). Only hierarchical Z removes hidden fragments
// early.
#pragma once

#include <vector>

#include "pipeline/bins/bin.h"
#include "pipeline/sampling.h"
#include "pipeline/technique.h"
#include "pipeline/units/depth_test_unit.h"
#include "stages/picture/resolve.h"
#include "stages/samples/alpha_test.h"
#include "stages/samples/shading_point.h"

namespace beampipe {

inline constexpr int kMaxMsaaSamples = 1024;

// The format of a sample's colour. rgba16f: 12 bytes per sample with depth, as in the ACAA talk.
enum class SampleColor { rgb16f, rgba16f, rgba8, rgba32f };

struct MsaaOptions {
  int samples = 1;
  SampleColor color = SampleColor::rgb16f;
  ShadeAt at = ShadeAt::centre;
  AlphaCoverage alpha = AlphaCoverage::test;
  bool sorts_translucent = false;  // draws them last, far to near
  bool prepass = false;  // a depth pass first, so that only visible fragments are shaded. The picture is the same.
  bool motion = false;   // motion vectors from the samples' depths, for passes that need them
  ResolveSpace space = ResolveSpace::linear;
};

// Multisampling with samples anywhere in the pixel: 1..32 of them, in units of 1/256 px (0..255) from its upper left
// corner. It has no spec. Throws SpecError.
Technique msaa_at(const std::vector<glm::ivec2>& places);

// The stages of a bin. One sample in memory is the picture's pixel already; all others are resolved.
std::vector<StageId> forward_stages(const Framebuffer& framebuffer, const MsaaOptions& options,
                                    const MemoryParameters& memory);

// The depth test of forward shading, with colours. `sampling` must outlive it.
DepthTestUnit forward_surface(Bin& bin, const Sampling& sampling, const MsaaOptions& options);

// Draws and shades all triangles, with a depth pre-pass if there is one, and resolves the samples. Returns the picture.
// Stages: forward_stages().
std::vector<glm::vec4> draw_forward(Bin& bin, const MsaaOptions& options, DepthTestUnit& depth_test);

}  // namespace beampipe
