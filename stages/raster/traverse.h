// The traversal that both raster stages share: which cells of a grid a triangle touches.
//
// A cell is a pixel, or a part of one if pixels are super-resolved. Triangles and cells are closed sets and are tested
// exactly, in integers: a cell must touch the bounding box, and its corner that lies deepest inside an edge must be
// inside, for each edge. No cell that has area in common with the triangle is missed.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>

#include "simd/quad_rows.h"
#include "stages/data/sample_fragment.h"
#include "stages/data/setup_triangle.h"
#include "stages/data/tile.h"

namespace beampipe {

// A half-open range of cells, frame coordinates.
struct CellRange {
  std::int32_t x0, y0, x1, y1;
};

struct EdgeSet {
  std::array<Edge, 3> edges;
  explicit EdgeSet(const SetupTriangle& triangle)
      : edges{edge_of(triangle, 0), edge_of(triangle, 1), edge_of(triangle, 2)} {}
};

inline std::int32_t floor_divide(std::int32_t value, std::int32_t by_power_of_two) {
  return value >> std::countr_zero(static_cast<std::uint32_t>(by_power_of_two));
}

// The cells within the tile that the triangle's closed bounding box touches.
inline CellRange touched_range(const SetupTriangle& t, const Tile& tile, const CellGrid& grid) {
  const auto [x_low, x_high] = std::minmax({t.x[0], t.x[1], t.x[2]});
  const auto [y_low, y_high] = std::minmax({t.y[0], t.y[1], t.y[2]});
  const std::int32_t w = grid.cell_width(), h = grid.cell_height();
  return {std::max(floor_divide(x_low - 1, w), tile.x0 * grid.columns),
          std::max(floor_divide(y_low - 1, h), tile.y0 * grid.rows),
          std::min(floor_divide(x_high, w) + 1, tile.x1 * grid.columns),
          std::min(floor_divide(y_high, h) + 1, tile.y1 * grid.rows)};
}

// What the traversal did; stages/raster/traverse_cost.h charges it.
struct TraversalCounts {
  std::uint64_t boxes = 0;       // triangles whose bounding box was computed
  std::uint64_t traversals = 0;  // triangles whose bounding box touches a cell of the tile
  std::uint64_t cells_tested = 0;
  std::uint64_t cells_touched = 0;  // counted by those who visit them
};

// When a cell counts as full: the triangle covers the closed cell, or it owns every sample that the cell could have.
enum class FullMeans { area, samples };

// The traversal of one triangle after the other.
struct Traversal {
  Tile tile;
  CellGrid grid = {};
  FullMeans meaning = FullMeans::area;
  TraversalCounts counts = {};
};

// Edge k over the cells from the one with this upper left corner on, in 1/256 px. The numbers are integers that doubles
// hold.
inline EdgeOverCells edge_over_cells(const SetupTriangle& triangle, const Edge& edge, std::size_t k,
                                     const glm::ivec2& corner, const CellGrid& grid, FullMeans meaning) {
  const double a = edge.a, b = edge.b;
  const double right = a * grid.cell_width(), down = b * grid.cell_height();
  const double not_owned = meaning == FullMeans::samples && !edge.owns ? 1 : 0;
  return {.start = a * (corner.x - triangle.x[k]) + b * (corner.y - triangle.y[k]),
          .step = right,
          .down = down,
          .deepest = std::max(right, 0.0) + std::max(down, 0.0),
          .shallowest = std::min(right, 0.0) + std::min(down, 0.0) - not_owned};
}

// Calls visit(x, y, cells) for rows of quads that the triangle may touch, from top to bottom and from left to right.
// (x, y) is the upper left cell of the first quad. `set`: the triangle's edges.
template <class Visit>
void traverse_quads(const SetupTriangle& triangle, const EdgeSet& set, Traversal& traversal, Visit&& visit) {
  const CellGrid& grid = traversal.grid;
  const CellRange range = touched_range(triangle, traversal.tile, grid);
  TraversalCounts& counts = traversal.counts;
  ++counts.boxes;
  if (range.x0 >= range.x1 || range.y0 >= range.y1) return;
  ++counts.traversals;
  counts.cells_tested +=
      static_cast<std::uint64_t>(range.x1 - range.x0) * static_cast<std::uint64_t>(range.y1 - range.y0);
  constexpr std::int32_t kCells = 2 * kQuadsPerRow, kRows = 16;
  constexpr std::uint64_t kAll = ~std::uint64_t{0}, kUpper = 0x3333333333333333, kLower = ~kUpper;
  constexpr std::uint64_t kFirstColumn = 0b0101, kLastColumn = 0b1010;  // of a quad
  QuadRow rows[kRows];
  const std::int32_t x0 = range.x0 & ~1, y0 = range.y0 & ~1;  // the range may start and end inside a quad
  const std::int32_t at_once = range.x1 - x0 <= kCells ? kRows : 1;
  for (std::int32_t top = y0; top < range.y1; top += 2 * at_once) {
    for (std::int32_t left = x0; left < range.x1; left += kCells) {
      EdgeOverCells edges[3];
      for (std::size_t k = 0; k < 3; ++k)
        edges[k] = edge_over_cells(triangle, set.edges[k], k, {left * grid.cell_width(), top * grid.cell_height()},
                                   grid, traversal.meaning);
      const std::int32_t quads = std::min((range.x1 - left + 1) / 2, kQuadsPerRow);
      const std::int32_t count = std::min((range.y1 - top + 1) / 2, at_once);
      quad_rows(edges, static_cast<std::size_t>(quads), static_cast<std::size_t>(count), rows);
      const std::uint64_t sides = (left < range.x0 ? ~kFirstColumn : kAll) &
                                  (left + 2 * quads > range.x1 ? ~(kLastColumn << 4 * (quads - 1)) : kAll);
      for (std::int32_t row = 0; row < count; ++row) {
        const std::int32_t y = top + 2 * row;
        const std::uint64_t inside = sides & (y < range.y0 ? kLower : kAll) & (y + 1 == range.y1 ? kUpper : kAll);
        visit(left, y, QuadRow{rows[row].touched & inside, rows[row].full & inside});
      }
    }
  }
}

// Where cell number `bit` of a row of quads is, from the first one.
inline std::int32_t column_of(int bit) { return (bit >> 2) * 2 + (bit & 1); }
inline std::int32_t row_of(int bit) { return bit >> 1 & 1; }

}  // namespace beampipe
