// motion: the nearest surface of each pixel -> how far it has moved on the screen since the last frame.
//
// contents() does the same for everything in a pixel: whether it still looks the same, and how fast it moves.
// camera_speeds() tells how far the camera alone has moved the nearest surface.
//
// Motion follows both frames' cameras and both transforms of the surface's draw, and vertices that move within their
// mesh, as those of skinned and morphed models do. The background counts as the far plane of a world that stands still.
// So does what a draw's state paints behind the world; what it paints in front counts as the near plane.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "stages/cost/counters.h"
#include "stages/data/frame_history.h"
#include "stages/data/sample_tile.h"
#include "traces/trace.h"

namespace beampipe {

// `placements`: one per draw; empty if no draw has state.
Poses poses_of(const Frame& frame, const std::vector<DrawPlacement>& placements = {});

// Returns, for each draw, the mesh that it had in the last frame, if only its vertices' places differ from those of the
// mesh that it has now; else null. Empty if there is no such draw.
std::vector<const Mesh*> meshes_before(const Trace& trace, const Poses& now, const Poses& before);

// A draw whose vertices have moved within its mesh.
struct Deformation {
  const Mesh *now, *before;
  glm::dmat4 to_screen, to_last_screen;  // from the mesh now, and before, to clip space, whose z is not needed
};

struct Deformations {
  std::vector<std::optional<Deformation>> draws;      // of the frame; empty if none is deformed
  const std::vector<std::uint32_t>& trace_triangles;  // as SetupTriangles has them
};

// `trace_triangles` must outlive the result.
Deformations deformations(const Trace& trace, const Poses& now, const Poses& before,
                          const std::vector<std::uint32_t>& trace_triangles);

// Returns the matrices from this frame's clip space to that of the last frame: one for each draw, and then one for
// everything that stands still. A draw is recognized by its index and its mesh. If the last frame does not have it, it
// counts as having stood still.
std::vector<glm::dmat4> to_last_frame(const Poses& now, const Poses& before);

// What tells a surface's draw, and with it how it moves.
enum class MotionFrom {
  ids,    // visibility ids beside the depths
  depth,  // nothing: what stands still is reprojected from its depth. The vectors of draws that move are right too, but
          // drawing these a second time to find them, as renderers without visibility ids do, is not charged.
};

// A tile of a frame, and how its draws move.
struct MovingTile {
  const Tile& tile;
  const Frame& frame;
  const std::vector<std::uint32_t>& draws;  // one per triangle
  const std::vector<glm::dmat4>& to_last;   // as to_last_frame returns them
  const Deformations* deformed = nullptr;   // null: no draw is
};

// What is read of a pixel's triangle if its draw is deformed: three indices, and its vertices in both meshes.
inline constexpr std::uint64_t kMovedTriangleBytes = 3 * 4 + 6 * 12;

// How many pixels of the tile show a deformed draw at their nearest sample.
std::uint64_t deformed_pixels(const SampleTile& surface, const MovingTile& in);

// Returns, for each pixel of the tile, row by row, the vector from a point of the nearest surface to where that was: in
// pixels, rounded to fp16; infinity if it was behind the eye.
std::vector<glm::vec2> motion(const SampleTile& surface, const MovingTile& in, StageCounters& counters,
                              MotionFrom from = MotionFrom::ids);

// Returns, for each draw and then for the background, a hash of everything that its colours depend on: the index of the
// draw and its mesh, its Kd, shading and light and, if it is lit, its orientation. Its position has no influence.
std::vector<std::uint32_t> looks_of(const Frame& frame);

// What the samples of each pixel of a tile show, row by row.
struct PixelContents {
  std::vector<std::uint32_t> looks;  // exclusive or of the looks of all draws in the pixel, the background included
  std::vector<float> speeds;  // of the fastest of these draws, each taken at its first sample: pixels, rounded to fp16
};

PixelContents contents(const SampleTile& surface, const MovingTile& in, const std::vector<std::uint32_t>& looks,
                       StageCounters& counters);

// Returns how far the point that motion() follows would have moved if its draw stood still, row by row: pixels, rounded
// to fp16. Its depth comes from motion().
std::vector<float> camera_speeds(const SampleTile& surface, const MovingTile& in, StageCounters& counters);

}  // namespace beampipe
