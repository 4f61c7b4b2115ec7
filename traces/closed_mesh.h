// Which meshes are closed, so that their back faces are hidden from outside if they are opaque.
#pragma once

#include "traces/trace.h"

namespace beampipe {

// Does the mesh have no border: does each edge have as many triangles that run along it in one direction as in the
// other? Vertices at the same position count as one, whatever else they have. A mesh without triangles is closed.
bool is_closed(const Mesh& mesh);

// Is it closed, and are its triangles counter-clockwise when seen from outside? (The volume that it encloses is then
// positive. Several bodies in a mesh are judged together.)
bool is_closed_body(const Mesh& mesh);

}  // namespace beampipe
