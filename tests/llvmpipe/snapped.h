// What a rasterizer that clips to the frame and computes in float may have seen of a triangle.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <vector>

#include "stages/data/setup_triangle.h"

namespace beampipe {

using ClipTriangle = std::array<glm::vec4, 3>;  // clip space, y up

// Does a vertex lie outside the view volume?
bool needs_clipping(const ClipTriangle& clip);

// The triangle clipped to the view volume, projected to a frame of size x size pixels and snapped to 1/256 px: every
// way in which coordinates too near the middle between two grid points for float to tell can be snapped, and the
// clipped polygon cut into triangles from each of its corners.
std::vector<SetupTriangles> snapped_alternatives(const ClipTriangle& clip, int size);

}  // namespace beampipe
