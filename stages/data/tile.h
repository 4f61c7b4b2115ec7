// A tile: the rectangle of pixels that is worked on at once. Its corners have even coordinates, so that no 2x2 quad is
// split between tiles.
#pragma once

#include <cstdint>
#include <vector>

#include "stages/data/setup_triangle.h"

namespace beampipe {

// A pixel of the frame.
struct PixelAddress {
  std::uint32_t x, y;
  bool operator==(const PixelAddress&) const = default;
};

struct Tile {
  std::int32_t x0 = 0, y0 = 0, x1 = 0, y1 = 0;  // [x0, x1) x [y0, y1), inside the frame

  std::int32_t width() const { return x1 - x0; }
  std::int32_t height() const { return y1 - y0; }
  // The number of a pixel within the tile, row by row. (x, y): frame coordinates.
  std::size_t index(std::int32_t x, std::int32_t y) const {
    return static_cast<std::size_t>(y - y0) * static_cast<std::size_t>(width()) + static_cast<std::size_t>(x - x0);
  }
  bool holds(PixelAddress pixel) const {
    const auto x = static_cast<std::int32_t>(pixel.x), y = static_cast<std::int32_t>(pixel.y);
    return x >= x0 && x < x1 && y >= y0 && y < y1;
  }
  std::size_t index(PixelAddress pixel) const {
    return index(static_cast<std::int32_t>(pixel.x), static_cast<std::int32_t>(pixel.y));
  }
  std::size_t pixels() const { return static_cast<std::size_t>(width()) * static_cast<std::size_t>(height()); }
};

// The triangles whose bounding boxes touch a tile, in primitive order: indices into SetupTriangles.
using TriangleList = std::vector<std::uint32_t>;

}  // namespace beampipe
