// Chooses where the camera stands for a model that has none: outside, or inside of a room.
#pragma once

#include <cstdint>
#include <optional>

#include "tools/cli/framing.h"
#include "traces/trace.h"

namespace beampipe {

enum class Standpoint {
  outside,    // at the front left and a little above, as frame_model() stands
  open_side,  // outside, looking straight into the model through a side that is open
  inside,     // in a room, looking at its middle from where most of it is in sight
};

struct Viewpoint {
  Standpoint standpoint = Standpoint::outside;
  Camera camera;
};

// A camera with these wishes, which name no eye. Walls that show their backs tell that a model is made to be seen from
// inside: surfaces at the sides of its bounds. If they are a quarter or less of what the camera sees of the model
// outside, it stays there. Else it goes to the open side where they are fewest, if they are a quarter or less there,
// and else inside, if that shows something. `asked`: the user's own choice of outside or inside. Throws
// std::invalid_argument, one line, as frame_model() does.
Viewpoint choose_viewpoint(const Trace& trace, std::uint32_t width, std::uint32_t height, const CameraWishes& wishes,
                           std::optional<Standpoint> asked);

}  // namespace beampipe
