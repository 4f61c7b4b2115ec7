// motion: the nearest surface of each pixel -> how far away on the screen it was in the last frame.
//
// Both frames' cameras and both transforms of the surface's draw are followed; vertices that move within their mesh are
// not. The background is taken for the far plane of a world that stands still.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "stages/counters.h"
#include "stages/depth_test.h"
#include "traces/trace.h"

namespace beampipe {

inline constexpr std::uint32_t kMotionBytes = 4;  // two fp16 numbers per pixel
inline constexpr std::uint32_t kDrawBytes = 2;    // a draw's number per pixel, where it is kept

// What places a frame's draws on its screen.
struct Poses {
  struct Pose {
    std::uint32_t mesh;
    glm::dmat4 transform;
  };
  glm::dmat4 view_projection{1.0};  // without jitter
  std::vector<Pose> draws;
};

Poses poses_of(const Frame& frame);

// Clip space of this frame to that of the last one: for each draw, and behind them for what stands still. A draw is
// known again by its index and its mesh; one that was not there before is taken to have stood still.
std::vector<glm::dmat4> to_last_frame(const Poses& now, const Poses& before);

// Of the nearest surface of each pixel of a tile, row by row.
struct SurfaceMotion {
  std::vector<glm::vec2> vectors;    // pixels, rounded to fp16: from a point to where it was; behind the eye: infinity
  std::vector<std::uint32_t> draws;  // whose it is; kNoDraw: the background
};
inline constexpr std::uint32_t kNoDraw = ~0u;

// `draws`: one per triangle.
SurfaceMotion motion(const SampleTile& surface, const Tile& tile, const Frame& frame,
                     const std::vector<std::uint32_t>& draws, const std::vector<glm::dmat4>& to_last,
                     StageCounters& counters);

}  // namespace beampipe
