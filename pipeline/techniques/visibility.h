// A visibility buffer: triangle ids and depth at N samples per pixel first, then materials and light sample by sample,
// without quads.
#pragma once

#include <vector>

#include "pipeline/bins/bin.h"
#include "pipeline/technique.h"
#include "pipeline/units/depth_test_unit.h"
#include "stages/samples/materials.h"

namespace beampipe {

inline constexpr int kMaxVisibilitySamples = 16;

struct VisibilityOptions {
  int samples = 1;  // per pixel: 1, 2, 4, 8 or 16
};

// ---- Steps that other techniques share ----

// Draws triangle ids and depths at the samples. Stages: sample_raster, depth_test.
void draw_visibility(Bin& bin, DepthTestUnit& visibility);

// Materials, light and resolve of a visibility buffer, with translucent triangles over that. Returns the picture.
// Stages: material_sort, shade, light, resolve, and those of draw_translucent.
std::vector<glm::vec4> shade_visibility(Bin& bin, const Materials& materials, DepthTestUnit& visibility);

// `samples`: per pixel.
Framebuffer visibility_framebuffer(int samples = 1);

}  // namespace beampipe
