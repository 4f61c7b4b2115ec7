// Procedural scenes: traces with one frame each, made from a triangle budget and a seed. Like an engine, they do not
// draw the back faces of closed meshes.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "traces/trace.h"

namespace beampipe {

struct SceneOptions {
  std::uint32_t triangles = 0;              // about this many, at most 100 million; 0: the scene's own default
  std::uint64_t seed = 1;                   // the same seed makes the same scene on every machine
  std::uint32_t width = 320, height = 180;  // pixels, each 1..16384
};

struct SceneKind {
  std::string_view name;         // "hairball", "classroom", ...
  std::string_view description;  // one line that says what makes it hard
  Trace (*make)(const SceneOptions&);
  bool has_materials = false;  // of all triangles; otherwise each triangle has one colour
  // Only measured: no rule and no constant of a technique was or may be chosen on it.
  bool is_held_out = false;
};

// All procedural scenes, in a fixed order.
const std::vector<SceneKind>& scene_kinds();

// Makes a scene. Scenes do not get much smaller than a thousand triangles. The camera depends only on the picture's
// size. Throws std::invalid_argument if `name` is not one of scene_kinds(), or if an option is out of range.
Trace make_scene(std::string_view name, const SceneOptions& options);

}  // namespace beampipe
