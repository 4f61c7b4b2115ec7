// One sample per pixel, shaded after visibility is known: triangle ids and depth, then materials and light per pixel,
// without quads.
#pragma once

#include "pipeline/memory/sample_memory.h"
#include "pipeline/technique.h"
#include "pipeline/tiles.h"
#include "stages/raster/sample_raster.h"

namespace beampipe {

FrameResult render_visibility(const Trace& trace, const Frame& frame, const RunOptions& run);

// What `visibility` does in a tile: its triangle ids and depths stay in `surface`, and in memory. `sampling`: of one
// sample.
TileResult visibility_tile(const SetupTriangles& triangles, const TriangleList& list, const Tile& tile,
                           const Sampling& sampling, const std::vector<glm::vec3>& colors, const glm::vec3& background,
                           const RunOptions& run, SampleMemory& memory, SampleTile& surface);

std::vector<Surface> visibility_framebuffer();

}  // namespace beampipe
