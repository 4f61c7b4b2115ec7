// Normals and tangents for meshes that lack them.
#pragma once

#include <cstddef>

#include "traces/trace.h"

namespace beampipe {

// The vector's direction with a length of 1; zero if it has none, or an infinite length.
glm::vec3 unit_or_zero(const glm::dvec3& vector);

// Gives each triangle three vertices of its own, with the triangle's normal. Of a triangle without area, that is +z.
void add_flat_normals(Mesh& mesh);

// Replaces the normals that have no length by means of the normals of the triangles around them, weighted by area.
// Returns how many there were.
std::size_t mend_normals(Mesh& mesh);

// Adds tangents from the texture coordinates `uv_set`, for a normal map that uses these. The mesh must have them, and
// normals. Where they give no direction, the tangent is any that is perpendicular to the normal.
//
// A tangent is the mean of those of the triangles around the vertex, perpendicular to its normal. w is 1 where normal x
// tangent points towards smaller v, which is up in the image, as in glTF. Triangles that share a vertex share its sign.
// Source: E. Lengyel, Foundations of Game Engine Development, volume 2, section 7.5. (glTF asks for MikkTSpace, which
// weights the triangles by their angles and splits vertices where signs differ.)
void add_tangents(Mesh& mesh, std::size_t uv_set);

}  // namespace beampipe
