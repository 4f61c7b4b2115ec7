// Tile scheduling: triangles into tiles, tiles onto threads, tiles' results into the frame's. The result does not
// depend on the number of threads or on the tile size.
#pragma once

#include <functional>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "pipeline/technique.h"
#include "stages/counters.h"
#include "stages/setup_triangle.h"
#include "stages/tile.h"

namespace beampipe {

// What a technique makes of one tile. Images and counters: one value per pixel of the tile, row by row.
struct TileResult {
  std::vector<glm::vec4> image;
  std::vector<std::pair<std::string, std::vector<float>>> pixel_counters;
  std::vector<StageCounters> stages;  // in pipeline order, the same stages for every tile
};

using TileRenderer = std::function<TileResult(const Tile&, const TriangleList&)>;

// Renders the frame tile by tile. `tile_size` in pixels, even. The raster stage, the first of every tile's, is charged
// with reading each setup triangle once.
FrameResult render_tiles(const Frame& frame, const SetupTriangles& triangles, const StageCounters& vertex_setup,
                         int tile_size, const RunOptions& options, const TileRenderer& renderer);

// For stages that work on whole frames. A tile's values, one per pixel, go to their places in `frame_values`; tiles may
// do so at the same time.
void copy_to_frame(const float* tile_values, const Tile& tile, const Frame& frame, std::vector<float>& frame_values);
std::vector<glm::vec4> pixels_of(const Image& image);
Image image_of(const Frame& frame, const std::vector<glm::vec4>& pixels);

}  // namespace beampipe
