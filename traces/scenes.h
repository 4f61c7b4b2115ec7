// Procedural scenes: traces with one frame each, made from a triangle budget and a seed.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "traces/trace.h"

namespace beampipe {

struct SceneOptions {
  std::uint32_t triangles = 0;              // about how many to make, at most 100 million; 0: the scene's own default
  std::uint64_t seed = 1;                   // same seed, same scene, on every machine
  std::uint32_t width = 320, height = 180;  // pixels, each 1..16384
};

struct SceneKind {
  std::string_view name;         // "hairball", "classroom", ...
  std::string_view description;  // one line: what is hard in it
  Trace (*make)(const SceneOptions&);
};

// All procedural scenes, in a fixed order.
const std::vector<SceneKind>& scene_kinds();

// Makes a scene. Below about a thousand triangles it keeps its least form. The camera depends on the picture's size
// only. Throws std::invalid_argument, naming the known scenes when `name` is not one of them.
Trace make_scene(std::string_view name, const SceneOptions& options);

}  // namespace beampipe
