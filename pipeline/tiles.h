// Tile scheduling: triangles into tiles, tiles onto threads, tiles' results into the frame's. The result does not
// depend on the number of threads, the pictures not on the tile size either. (Passes of streaming order and the
// modelled caches go tile by tile, so that their counters do.)
#pragma once

#include <algorithm>
#include <functional>
#include <glm/glm.hpp>
#include <map>
#include <string>
#include <vector>

#include "pipeline/technique.h"
#include "stages/cost/counters.h"
#include "stages/data/setup_triangle.h"
#include "stages/data/tile.h"

namespace beampipe {

// The most bytes that a bin's buffers hold, by name.
class BinBuffers {
 public:
  void holds(const std::string& name, std::uint64_t bytes) {
    std::uint64_t& peak = peaks_[name];
    peak = std::max(peak, bytes);
  }
  const std::map<std::string, std::uint64_t>& peaks() const { return peaks_; }

 private:
  std::map<std::string, std::uint64_t> peaks_;
};

// What a technique makes of one tile. Images and counters: one value per pixel of the tile, row by row.
struct TileResult {
  std::vector<glm::vec4> image;  // may be empty, when a later stage makes the frame's
  std::vector<std::pair<std::string, std::vector<float>>> pixel_counters;
  std::vector<StageCounters> stages;  // in pipeline order, the same stages for every tile
  BinBuffers buffers = {};
  int passes = 1;  // in which an application draws the frame
};

using TileRenderer = std::function<TileResult(const Tile&, const TriangleList&)>;

// Renders the frame tile by tile. `tile_size` in pixels, even, where the options name none. `vertex_setup`: of one
// pass; it runs in each pass, and the raster stage, the first of every tile's, reads each setup triangle (in memory,
// each bin those of its list). `pair_bytes`: what the renderer keeps, until the tile is done, for each pixel that a
// triangle touches (RunOptions::memory_limit); 0 when it works on a few triangles at a time.
FrameResult render_tiles(const Frame& frame, const SetupTriangles& triangles, const StageCounters& vertex_setup,
                         int tile_size, const RunOptions& options, std::size_t pair_bytes,
                         const TileRenderer& renderer);

inline FrameResult render_tiles(const Frame& frame, const SetupTriangles& triangles, const StageCounters& vertex_setup,
                                int tile_size, const RunOptions& options, const TileRenderer& renderer) {
  return render_tiles(frame, triangles, vertex_setup, tile_size, options, 0, renderer);
}

// For a stage behind those of the tiles that looks at whole frames and makes one tile's pixels at a time: calls
// work(tile, counters) for each tile, and adds up the counters.
void for_each_tile(const Frame& frame, int tile_size, const RunOptions& options, StageCounters& counters,
                   const std::function<void(const Tile&, StageCounters&)>& work);

// A tile's values, one per pixel, to their places in the frame's; tiles may do so at the same time.
template <class Value>
void copy_to_frame(const std::vector<Value>& tile_values, const Tile& tile, const Frame& frame,
                   std::vector<Value>& frame_values) {
  const Value* from = tile_values.data();
  for (std::int32_t y = tile.y0; y < tile.y1; ++y, from += tile.width())
    std::copy_n(from, tile.width(),
                frame_values.data() + static_cast<std::size_t>(y) * frame.width + static_cast<std::size_t>(tile.x0));
}

// A frame's pixels, row by row, into its picture.
void copy_to_image(const std::vector<glm::vec4>& pixels, Image& image);

}  // namespace beampipe
