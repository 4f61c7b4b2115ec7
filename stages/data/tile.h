// A tile: the rectangle of pixels that is worked on at once. Its corners have even coordinates, so that no 2x2 quad is
// split between tiles.
#pragma once

#include <cstdint>
#include <vector>

#include "stages/data/setup_triangle.h"

namespace beampipe {

struct Tile {
  std::int32_t x0 = 0, y0 = 0, x1 = 0, y1 = 0;  // [x0, x1) x [y0, y1), inside the frame

  std::int32_t width() const { return x1 - x0; }
  std::int32_t height() const { return y1 - y0; }
  // The number of a pixel within the tile, row by row. (x, y): frame coordinates.
  std::size_t index(std::int32_t x, std::int32_t y) const {
    return static_cast<std::size_t>(y - y0) * static_cast<std::size_t>(width()) + static_cast<std::size_t>(x - x0);
  }
  std::size_t pixels() const { return static_cast<std::size_t>(width()) * static_cast<std::size_t>(height()); }
};

// The triangles whose bounding boxes touch a tile, in primitive order: indices into SetupTriangles.
using TriangleList = std::vector<std::uint32_t>;

}  // namespace beampipe
