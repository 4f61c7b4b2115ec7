// A visibility buffer with one sample per pixel: triangle ids and depth first, then materials and light pixel by pixel,
// without quads.
#pragma once

#include <vector>

#include "pipeline/bins/bin.h"
#include "pipeline/technique.h"
#include "pipeline/units/depth_test_unit.h"

namespace beampipe {

// ---- Steps that other techniques share ----

// Draws triangle ids and depths at the samples. Stages: sample_raster, depth_test.
void draw_visibility(Bin& bin, const Sampling& sampling, DepthTestUnit& visibility);

// Materials, light and resolve of a visibility buffer of one sample per pixel, with translucent triangles over that.
// Returns the picture. Stages: shade, light, resolve, and those of draw_translucent.
std::vector<glm::vec4> shade_visibility(Bin& bin, DepthTestUnit& visibility);

Framebuffer visibility_framebuffer();

}  // namespace beampipe
