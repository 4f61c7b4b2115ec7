// Deferred shading with one sample per pixel: a depth pass, then materials in 2x2 quads into a G-buffer, then light.
#pragma once

#include <vector>

#include "pipeline/bins/bin.h"
#include "pipeline/technique.h"
#include "pipeline/units/depth_test_unit.h"

namespace beampipe {

// A depth pre-pass, then materials, light and resolve, with translucent triangles over that. Returns the picture.
// `depth_test`: of one sample per pixel and depth alone. Stages, of a plan with a pre-pass: sample_raster, depth_test,
// shade, light, resolve.
std::vector<glm::vec4> draw_deferred(Bin& bin, DepthTestUnit& depth_test);

Framebuffer deferred_framebuffer();

}  // namespace beampipe
