// Lists of scenes for tests with parameters, which googletest prints as their names. It would print their bytes
// otherwise.
#pragma once

#include <ostream>
#include <vector>

#include "traces/scenes.h"

namespace beampipe {

inline void PrintTo(const SceneKind& kind, std::ostream* out) { *out << kind.name; }

inline std::vector<SceneKind> scenes_with_materials(bool has_materials) {
  std::vector<SceneKind> scenes;
  for (const SceneKind& kind : scene_kinds())
    if (kind.has_materials == has_materials) scenes.push_back(kind);
  return scenes;
}

// Two lists, and not one, as much holds only for flat triangles: a twin that has their one colour, or a frame without
// textures, which pays nothing for them. What holds for both is tested on scene_kinds().
inline std::vector<SceneKind> flat_scenes() { return scenes_with_materials(false); }
inline std::vector<SceneKind> material_scenes() { return scenes_with_materials(true); }

}  // namespace beampipe
