// Bands: runs of tiles that are rendered together. They keep the memory for lists and pairs below a limit. A band
// consists of whole tiles, so results do not depend on bands.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "stages/data/setup_triangle.h"
#include "stages/data/tile.h"
#include "stages/surface/surface_shader.h"
#include "traces/trace.h"

namespace beampipe {

// The tiles of a frame, row by row.
struct TileGrid {
  std::int32_t size = 0, columns = 0;  // pixels on each side; tiles in a row
  std::vector<Tile> tiles;

  TileGrid(const Frame& frame, std::int32_t tile_size);

  // pixels / size. `pixels`: 0..2^15; frames have up to 2^14 on each side. The size: 1..2^15.
  std::int32_t tiles_in(std::int32_t pixels) const {
    return static_cast<std::int32_t>(static_cast<std::uint64_t>(pixels) * inverse_ >> 32);
  }

 private:
  std::uint64_t inverse_;  // of the size, times 2^32: multiplication is much faster than division
};

struct Band {
  std::size_t first, last;  // tiles [first, last)
};

// What a technique keeps for each pair until its tile is finished, in bytes.
struct PairBytes {
  std::size_t each = 0;                   // of every pair
  std::size_t translucent = 0;            // of those of translucent triangles, in addition
  const SurfaceShader* shader = nullptr;  // knows which triangles are; null: none is

  std::size_t of(std::uint32_t triangle) const {
    const bool is_translucent = shader && !shader->is_opaque(triangle) && !shader->is_cutout(triangle);
    return each + (is_translucent ? translucent : 0);
  }
};

// Splits all tiles, in order, into bands: a single one without a limit (0 bytes) or when the whole frame fits. A band
// needs the triangle lists of all its tiles, and memory for the pairs of the tiles that are rendered at once, one per
// thread. Throws std::runtime_error, one line that says how much is needed, when a single tile does not fit.
std::vector<Band> split_into_bands(const SetupTriangles& triangles, const TileGrid& grid, const PairBytes& pair_bytes,
                                   int threads, std::uint64_t memory_limit);

// One list per tile of the band: the triangles whose closed bounds touch it.
std::vector<TriangleList> bin_triangles(const SetupTriangles& triangles, const TileGrid& grid, const Band& band);

}  // namespace beampipe
