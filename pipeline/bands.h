// Bands: runs of tiles that are worked on at once, so that what they keep for each triangle fits into the memory that a
// frame may take. A band is of whole tiles, so that results do not depend on it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "stages/data/setup_triangle.h"
#include "stages/data/tile.h"
#include "traces/trace.h"

namespace beampipe {

// The tiles of a frame, row by row.
struct TileGrid {
  std::int32_t size = 0, columns = 0;  // pixels on each side; tiles in a row
  std::vector<Tile> tiles;

  TileGrid(const Frame& frame, std::int32_t tile_size);
};

struct Band {
  std::size_t first, last;  // tiles [first, last)
};

// In order, all tiles together: one band where there is no limit (0 bytes) or the whole frame fits. What counts: for
// each tile of a band the list of its triangles, and for those that are worked on, one per thread, `pair_bytes` for
// each pixel that a triangle touches. Throws std::runtime_error, one line that says how much is needed, when a single
// tile does not fit.
std::vector<Band> split_into_bands(const SetupTriangles& triangles, const TileGrid& grid, std::size_t pair_bytes,
                                   int threads, std::uint64_t memory_limit);

// One list per tile of the band: the triangles whose closed bounds touch it.
std::vector<TriangleList> bin_triangles(const SetupTriangles& triangles, const TileGrid& grid, const Band& band);

}  // namespace beampipe
