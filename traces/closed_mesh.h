// Which meshes are closed, so that their back faces are always hidden.
#pragma once

#include "traces/trace.h"

namespace beampipe {

// Does the mesh have no border: does each edge have as many triangles that run along it in one direction as in the
// other? Vertices at the same position count as one, whatever else they have. A mesh without triangles is closed.
bool is_closed(const Mesh& mesh);

}  // namespace beampipe
