// The triangles that a rasterizer may see in place of a given one if it clips to the frame and computes in float.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <vector>

#include "stages/data/setup_triangle.h"

namespace beampipe {

using ClipTriangle = std::array<glm::vec4, 3>;  // clip space, y up

// Does a vertex lie outside the view volume?
bool needs_clipping(const ClipTriangle& clip);

// Clips the triangle to the view volume, projects it to a frame of size x size pixels and snaps it to 1/256 px. There
// is an alternative for each way to snap the coordinates that are too near the middle between two grid points to be
// decided in float, and for each corner from which the clipped polygon can be cut into triangles.
std::vector<SetupTriangles> snapped_alternatives(const ClipTriangle& clip, int size);

}  // namespace beampipe
