// Splitting polygons into triangles.
#pragma once

#include <cstddef>
#include <glm/glm.hpp>
#include <vector>

namespace beampipe {

// Returns the n - 2 triangles of a simple and nearly planar polygon, which may be concave: indices into `corners`, with
// the polygon's winding. Works by ear clipping. Any other polygon also gives n - 2 triangles, but they may overlap.
std::vector<glm::uvec3> triangulate(const std::vector<glm::vec3>& corners);

}  // namespace beampipe
