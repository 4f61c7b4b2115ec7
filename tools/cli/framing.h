// Chooses a camera and a light for a model that has none.
#pragma once

#include <glm/glm.hpp>
#include <optional>

#include "traces/trace.h"

namespace beampipe {

// What the user has asked for; everything else is chosen.
struct CameraWishes {
  std::optional<glm::dvec3> eye, target, up;
  std::optional<double> fovy_deg, near, far;
};

// A camera that looks at the middle of what a trace shows in all its frames, from the front right and a little above,
// with y up and a vertical angle of 36 degrees. It is just far enough away to see all of it, and its near and far
// planes enclose it. Throws std::invalid_argument, one line, if the frames show no triangles, a single point or
// something that lies behind the eye, or if there is no camera with these wishes.
Camera frame_model(const Trace& trace, std::uint32_t width, std::uint32_t height, const CameraWishes& wishes);

// The direction in which light travels that comes over the viewer's left shoulder, from above.
glm::vec3 shoulder_light(const Camera& camera);

}  // namespace beampipe
