#include "tools/cli/camera_file.h"

#include <limits>

#include "traces/files/json.h"
#include "traces/files/json_cursor.h"

namespace beampipe {

CameraWishes read_camera_file(const std::string& file) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const Json json = parse_json(file);
  const JsonCursor at(json, file);
  at.expect_keys({"eye", "target", "up", "fovy_deg", "near", "far"});
  CameraWishes wishes;
  wishes.eye = at["eye"].vec3();
  wishes.target = at["target"].vec3();
  if (const auto up = at.find("up")) wishes.up = up->vec3();
  if (const auto fovy = at.find("fovy_deg")) wishes.fovy_deg = fovy->number_between(0, 180);
  if (const auto near = at.find("near")) wishes.near = near->number_between(0, kInfinity);
  if (const auto far = at.find("far")) wishes.far = far->number_between(0, kInfinity);
  return wishes;
}

}  // namespace beampipe
