// The boat, which is a scene with plain colours and, as the rigging, a scene with materials.
#pragma once

#include "traces/scenes/scene.h"

namespace beampipe {

// What things are made of: no materials in the boat. Lines are single; ropes are braided.
struct BoatLook {
  Finish hull, deck, house, spar, sail, line, rope, sea;
};

Trace boat_trace(const SceneOptions& options, std::uint32_t default_triangles, const BoatLook& look);

}  // namespace beampipe
