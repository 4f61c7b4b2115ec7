// A camera and a light for a mesh that comes without.
#pragma once

#include <glm/glm.hpp>
#include <optional>

#include "traces/trace.h"

namespace beampipe {

// What the user fixed; the rest is chosen.
struct CameraWishes {
  std::optional<glm::dvec3> eye, target, up;
  std::optional<double> fovy_deg, near, far;
};

// A camera that looks at the middle of the mesh from the front right and a little above (y up, 36 degrees), from just
// so far that all of it is in view; near and far enclose it. Throws std::invalid_argument, in one line, when the mesh
// has no triangles or is a single point, all of it is behind the eye, or the wishes make no camera.
Camera frame_mesh(const Mesh& mesh, std::uint32_t width, std::uint32_t height, const CameraWishes& wishes);

// Light that falls over the viewer's shoulder, from above and a little from the left.
glm::vec3 shoulder_light(const Camera& camera);

}  // namespace beampipe
