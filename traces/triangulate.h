// Splitting polygons into triangles.
#pragma once

#include <cstddef>
#include <glm/glm.hpp>
#include <vector>

namespace beampipe {

// Clips ears off a simple polygon, concave or not and nearly planar, and returns its n - 2 triangles as indices into
// `corners`, with the polygon's winding. Any other polygon also gives n - 2 triangles, which may overlap.
std::vector<glm::uvec3> triangulate(const std::vector<glm::vec3>& corners);

}  // namespace beampipe
