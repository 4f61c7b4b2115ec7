// The classroom, which is a scene with plain colours and, as the room, a scene with materials.
#pragma once

#include "traces/scenes/scene.h"

namespace beampipe {

// What things are made of: no materials in the classroom.
struct ClassroomLook {
  Finish wood, floor, plaster, ceiling, paint, board, steel, plastic, paper, globe, slats, cord, outside;
  bool is_plain() const { return wood.material == kNoMaterial; }
};

// The first mesh is the view outside and the ceiling.
Trace classroom_trace(const SceneOptions& options, std::uint32_t default_triangles, const ClassroomLook& look);

}  // namespace beampipe
