// Which cells of a grid a triangle touches: the traversal that both raster stages share.
//
// A cell is a pixel, or a part of one (super-resolution). Triangles and cells are closed sets, tested exactly in
// integers: the bounding box and, per edge, the cell's corner that lies deepest inside. No cell with common area is
// missed.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "simd/sample_pattern.h"
#include "stages/setup_triangle.h"
#include "stages/tile.h"

namespace beampipe {

// Cells per pixel in x and y; powers of two up to 16.
struct CellGrid {
  std::int32_t columns = 1, rows = 1;

  std::int32_t cell_width() const { return kSubpixelUnits / columns; }  // 1/256 px
  std::int32_t cell_height() const { return kSubpixelUnits / rows; }
  std::int32_t cells_per_pixel() const { return columns * rows; }
  bool operator==(const CellGrid&) const = default;
};

// Half-open range of cells in frame coordinates.
struct CellRange {
  std::int32_t x0, y0, x1, y1;
};

struct EdgeSet {
  std::array<Edge, 3> edges;
  explicit EdgeSet(const SetupTriangle& triangle)
      : edges{edge_of(triangle, 0), edge_of(triangle, 1), edge_of(triangle, 2)} {}
};

inline std::int32_t floor_divide(std::int32_t value, std::int32_t by_power_of_two) {
  return (value - (((value % by_power_of_two) + by_power_of_two) % by_power_of_two)) / by_power_of_two;
}

// The cells that the triangle's closed bounding box touches, within the tile.
inline CellRange touched_range(const SetupTriangle& t, const Tile& tile, const CellGrid& grid) {
  const auto [x_low, x_high] = std::minmax({t.x[0], t.x[1], t.x[2]});
  const auto [y_low, y_high] = std::minmax({t.y[0], t.y[1], t.y[2]});
  const std::int32_t w = grid.cell_width(), h = grid.cell_height();
  return {std::max(floor_divide(x_low - 1, w), tile.x0 * grid.columns),
          std::max(floor_divide(y_low - 1, h), tile.y0 * grid.rows),
          std::min(floor_divide(x_high, w) + 1, tile.x1 * grid.columns),
          std::min(floor_divide(y_high, h) + 1, tile.y1 * grid.rows)};
}

// What the traversal did, for the counters.
struct TraversalCounts {
  std::uint64_t cells_tested = 0;
  std::uint64_t cells_touched = 0;
};

enum class FullMeans { area, samples };  // covered to its closed border, or with every sample owned

// Calls visit(x, y, quad, full) for every touched cell, 2x2 quad by quad; `quad` counts up over all calls that share
// the counter. `full`: the triangle covers the whole cell.
template <class Visit>
void traverse(const SetupTriangle& triangle, const EdgeSet& set, const Tile& tile, const CellGrid& grid,
              FullMeans meaning, std::uint32_t& quad, TraversalCounts& counts, Visit&& visit) {
  const CellRange range = touched_range(triangle, tile, grid);
  if (range.x0 >= range.x1 || range.y0 >= range.y1) return;
  const std::int64_t w = grid.cell_width(), h = grid.cell_height();
  std::int64_t deepest[3], shallowest[3];  // from the cell's upper left corner to its extreme corners
  for (std::size_t k = 0; k < 3; ++k) {
    const Edge& edge = set.edges[k];
    const std::int64_t right = edge.a * w, down = edge.b * h;
    deepest[k] = std::max<std::int64_t>(right, 0) + std::max<std::int64_t>(down, 0);
    shallowest[k] = std::min<std::int64_t>(right, 0) + std::min<std::int64_t>(down, 0);
    if (meaning == FullMeans::samples && !edge.owns) shallowest[k] -= 1;
  }
  for (std::int32_t quad_y = range.y0 & ~1; quad_y < range.y1; quad_y += 2) {
    for (std::int32_t quad_x = range.x0 & ~1; quad_x < range.x1; quad_x += 2) {
      const std::uint64_t touched_before = counts.cells_touched;
      for (std::int32_t y = std::max(quad_y, range.y0); y < std::min(quad_y + 2, range.y1); ++y) {
        for (std::int32_t x = std::max(quad_x, range.x0); x < std::min(quad_x + 2, range.x1); ++x) {
          ++counts.cells_tested;
          bool touched = true, full = true;
          for (std::size_t k = 0; k < 3; ++k) {
            const std::int64_t corner = set.edges[k].at(x * w, y * h);
            touched &= corner + deepest[k] >= 0;
            full &= corner + shallowest[k] >= 0;
          }
          if (!touched) continue;
          ++counts.cells_touched;
          visit(x, y, quad, full);
        }
      }
      if (counts.cells_touched != touched_before) ++quad;
    }
  }
}

}  // namespace beampipe
