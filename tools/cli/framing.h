// Chooses a camera and a light for a model that has none.
#pragma once

#include <glm/glm.hpp>
#include <optional>

#include "traces/trace.h"

namespace beampipe {

// Of unit length and at right angles: a vector (x, y, z) in this basis is x right + y up + z back.
struct Basis {
  glm::dvec3 right, up, back;

  glm::dvec3 operator*(const glm::dvec3& vector) const { return vector.x * right + vector.y * up + vector.z * back; }
};

// The basis in which a model stands upright: x, y and z themselves if y is up, and x, z and -y if z is up. Throws
// std::invalid_argument, one line, if `up` is zero.
Basis upright_basis(const glm::dvec3& up);

struct Bounds {
  glm::dvec3 low, high;  // world space

  glm::dvec3 middle() const { return (low + high) * 0.5; }
};

// What encloses all that a trace shows in all its frames. Throws as frame_model() does.
Bounds shown_bounds(const Trace& trace);

// What the user has asked for; everything else is chosen.
struct CameraWishes {
  std::optional<glm::dvec3> eye, target, up;
  std::optional<double> fovy_deg, near, far;
  // Without an eye: the direction from the target to it, in the upright basis. Light over the left shoulder then falls
  // on all sides of a box that are seen.
  glm::dvec3 from{-0.5, 0.3, 1.0};
};

// A camera that looks at the middle of what a trace shows in all its frames, from the front left and a little above,
// with y up and a vertical angle of 36 degrees. It is just far enough away to see all of it, and its near and far
// planes enclose it. Throws std::invalid_argument, one line, if the frames show no triangles, a single point or
// something that lies behind the eye, or if there is no camera with these wishes.
Camera frame_model(const Trace& trace, std::uint32_t width, std::uint32_t height, const CameraWishes& wishes);

// The direction in which light travels that comes over the viewer's left shoulder, from above.
glm::vec3 shoulder_light(const Camera& camera);

}  // namespace beampipe
