// motion: the nearest surface of each pixel -> how far away on the screen it was in the last frame; all that is in the
// pixel -> whether it looks as it did, and how fast it moves.
//
// Both frames' cameras and both transforms of the surface's draw are followed; vertices that move within their mesh are
// not. The background is taken for the far plane of a world that stands still.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "stages/cost/counters.h"
#include "stages/samples/test_depth.h"
#include "traces/trace.h"

namespace beampipe {

inline constexpr std::uint32_t kMotionBytes = 4;  // two fp16 numbers per pixel
inline constexpr std::uint32_t kLookBytes = 4;    // per pixel, where they are kept
inline constexpr std::uint32_t kSpeedBytes = 2;   // an fp16 number per pixel, where it is kept

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

// Of the nearest surface of each pixel of a tile, row by row: pixels, rounded to fp16, from a point to where it was;
// behind the eye: infinity. `draws`: one per triangle.
std::vector<glm::vec2> motion(const SampleTile& surface, const Tile& tile, const Frame& frame,
                              const std::vector<std::uint32_t>& draws, const std::vector<glm::dmat4>& to_last,
                              StageCounters& counters);

// For each draw, and behind them for the background, a hash of all that its colours are made from: which draw and mesh
// it is, its Kd, shading, light and, where it is lit, which way it is turned. Where it is is not in it.
std::vector<std::uint32_t> looks_of(const Frame& frame);

// What the samples of each pixel of a tile show, row by row.
struct PixelContents {
  std::vector<std::uint32_t> looks;  // exclusive or of the looks of the draws, the background one of them
  std::vector<float> speeds;         // of the fastest of the draws, each at its first sample: pixels, rounded to fp16
};

PixelContents contents(const SampleTile& surface, const Tile& tile, const Frame& frame,
                       const std::vector<std::uint32_t>& draws, const std::vector<glm::dmat4>& to_last,
                       const std::vector<std::uint32_t>& looks, StageCounters& counters);

}  // namespace beampipe
