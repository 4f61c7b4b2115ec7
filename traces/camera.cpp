#include <glm/gtc/matrix_transform.hpp>
#include <stdexcept>

#include "traces/trace.h"

namespace beampipe {

void set_camera(Frame& frame, const Camera& camera) {
  const double aspect = static_cast<double>(frame.width) / frame.height;
  frame.camera = camera;
  frame.view = glm::lookAtRH(camera.eye, camera.target, camera.up);
  frame.projection = glm::perspectiveRH_NO(glm::radians(camera.fovy_deg), aspect, camera.near, camera.far);
}

void orbit_camera(Trace& trace, std::uint32_t frames, double degrees) {
  if (trace.frames.empty() || !trace.frames[0].camera || frames == 0)
    throw std::invalid_argument("expected a trace whose first frame names a camera, and at least one frame to make");
  const Frame first = trace.frames[0];
  trace.frames.assign(frames, first);
  for (std::uint32_t i = 1; i < frames; ++i) {
    const double angle = glm::radians(degrees) * i / (frames - 1);
    Camera camera = *first.camera;
    const glm::dmat4 turn = glm::rotate(glm::dmat4(1.0), angle, camera.up);
    camera.eye = camera.target + glm::dvec3(turn * glm::dvec4(camera.eye - camera.target, 0.0));
    set_camera(trace.frames[i], camera);
  }
}

void pan_picture(Trace& trace, std::uint32_t frames, double x, double y) {
  if (trace.frames.empty() || frames == 0)
    throw std::invalid_argument("expected a trace with a frame, and at least one frame to make");
  const Frame first = trace.frames[0];
  trace.frames.assign(frames, first);
  for (std::uint32_t i = 0; i < frames; ++i) {
    Frame& frame = trace.frames[i];
    const glm::dvec3 shift(2 * x * i / frame.width, -2 * y * i / frame.height, 0.0);  // in normalised coordinates, y up
    frame.projection = glm::translate(glm::dmat4(1.0), shift) * first.projection;
    frame.camera.reset();
  }
}

}  // namespace beampipe
