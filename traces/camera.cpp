#include <glm/gtc/matrix_transform.hpp>

#include "traces/trace.h"

namespace beampipe {

void set_camera(Frame& frame, const Camera& camera) {
  const double aspect = static_cast<double>(frame.width) / frame.height;
  frame.camera = camera;
  frame.view = glm::lookAtRH(camera.eye, camera.target, camera.up);
  frame.projection = glm::perspectiveRH_NO(glm::radians(camera.fovy_deg), aspect, camera.near, camera.far);
}

}  // namespace beampipe
