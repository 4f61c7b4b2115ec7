#include "tools/cli/camera_file.h"

#include <limits>

#include "traces/files/json_form.h"

namespace beampipe {
namespace {

Field<CameraWishes> point(const char* key, std::optional<glm::dvec3> CameraWishes::*place, const char* meaning) {
  return {key, meaning, true, form::vec3().schema,
          [place](const JsonCursor& at, CameraWishes& wishes) { wishes.*place = form::vec3()(at); }};
}

Form<CameraWishes> camera_form() {
  const Form<double> distance = form::number_between(0, std::numeric_limits<double>::infinity());
  return ObjectForm<CameraWishes>()
      .add(point("eye", &CameraWishes::eye, "Where the camera is, in world space, in scene units."))
      .add(point("target", &CameraWishes::target, "The point in the middle of the picture."))
      .optional("up", &CameraWishes::up, form::vec3(), "The direction that is up in the picture.")
      .optional("fovy_deg", &CameraWishes::fovy_deg, form::number_between(0, 180),
                "The vertical angle of view, in degrees.")
      .optional("near", &CameraWishes::near, distance, "Distance of the near plane, in scene units.")
      .optional("far", &CameraWishes::far, distance, "Distance of the far plane, in scene units.");
}

}  // namespace

Json camera_schema() { return schema_file(camera_form().schema, "beampipe camera"); }

CameraWishes read_camera_file(const std::string& file) {
  const Json json = parse_json(file);
  return camera_form()(JsonCursor(json, file));
}

}  // namespace beampipe
