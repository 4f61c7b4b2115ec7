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

#include "simd/cell_rows.h"
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
  std::uint64_t cells_touched = 0;  // only by traverse()
};

// When a cell counts as full: the triangle covers the closed cell, or it owns every sample that the cell could have.
enum class FullMeans { area, samples };

// The traversal of one triangle after the other.
struct Traversal {
  Tile tile;
  CellGrid grid = {};
  FullMeans meaning = FullMeans::area;
  TraversalCounts counts = {};
  std::uint32_t quad = 0;  // number of the next 2x2 quad
};

// What cell_rows needs of an edge, except for the value where the first row starts.
inline EdgeOverCells edge_over_cells(const Edge& edge, const CellGrid& grid, FullMeans meaning) {
  const std::int64_t right = std::int64_t{edge.a} * grid.cell_width(), down = std::int64_t{edge.b} * grid.cell_height();
  const std::int64_t not_owned = meaning == FullMeans::samples && !edge.owns ? 1 : 0;
  EdgeOverCells over{};
  over.step = static_cast<double>(right), over.down = static_cast<double>(down);
  over.deepest = static_cast<double>(std::max<std::int64_t>(right, 0) + std::max<std::int64_t>(down, 0));
  over.shallowest = static_cast<double>(std::min<std::int64_t>(right, 0) + std::min<std::int64_t>(down, 0) - not_owned);
  return over;
}

// Calls visit(left, y, rows) for two rows at a time of at most kCellsPerRow cells that the triangle may touch: bit i of
// rows[j] is cell (left + i, y + j). `left` and `y` are even. `set`: the triangle's edges.
template <class Visit>
void traverse_rows(const SetupTriangle& triangle, const EdgeSet& set, Traversal& traversal, Visit&& visit) {
  const CellGrid& grid = traversal.grid;
  const CellRange range = touched_range(triangle, traversal.tile, grid);
  TraversalCounts& counts = traversal.counts;
  ++counts.boxes;
  if (range.x0 >= range.x1 || range.y0 >= range.y1) return;
  ++counts.traversals;
  counts.cells_tested +=
      static_cast<std::uint64_t>(range.x1 - range.x0) * static_cast<std::uint64_t>(range.y1 - range.y0);
  const std::int64_t w = grid.cell_width(), h = grid.cell_height();
  EdgeOverCells edges[3];
  for (std::size_t k = 0; k < 3; ++k) edges[k] = edge_over_cells(set.edges[k], grid, traversal.meaning);
  for (std::int32_t y = range.y0 & ~1; y < range.y1; y += 2) {
    for (std::int32_t left = range.x0 & ~1; left < range.x1; left += kCellsPerRow) {
      const std::uint32_t inside = left < range.x0 ? ~1u : ~0u;  // the range may start inside a quad
      for (std::size_t k = 0; k < 3; ++k) edges[k].start = static_cast<double>(set.edges[k].at(left * w, y * h));
      auto [rows] = cell_rows(edges, static_cast<std::size_t>(std::min(range.x1 - left, kCellsPerRow)));
      for (std::int32_t j = 0; j < 2; ++j) rows[j].touched &= y + j >= range.y0 && y + j < range.y1 ? inside : 0;
      visit(left, y, rows);
    }
  }
}

// Calls visit(x, y, quad, full) for every cell that the triangle touches, one 2x2 quad after the other. `quad`: the
// same number for all cells in one quad. `full`: the triangle covers the whole cell.
template <class Visit>
void traverse(const SetupTriangle& triangle, const EdgeSet& set, Traversal& traversal, Visit&& visit) {
  traverse_rows(triangle, set, traversal, [&](std::int32_t left, std::int32_t top, const CellRow(&rows)[2]) {
    const std::uint32_t columns = rows[0].touched | rows[1].touched;
    constexpr std::uint32_t kEven = 0x55555555;
    for (std::uint32_t quads = (columns | columns >> 1) & kEven; quads != 0; quads &= quads - 1) {
      const int first = std::countr_zero(quads);
      for (std::int32_t y = 0; y < 2; ++y) {
        for (int x = first; x < first + 2; ++x) {
          if ((rows[y].touched >> x & 1) == 0) continue;
          ++traversal.counts.cells_touched;
          visit(left + x, top + y, traversal.quad, (rows[y].full >> x & 1) != 0);
        }
      }
      ++traversal.quad;
    }
  });
}

}  // namespace beampipe
