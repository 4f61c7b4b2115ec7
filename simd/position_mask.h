// Which mask positions of a pixel a triangle covers: the exact edge tests that msaa:N makes for its samples.
//
// The positions (cell_patterns in simd/sample_pattern.h) are the same 8 in every cell of a grid. So an edge's value at
// a position is the sum of two parts: its value at the same position of the first cell, which is computed once, and
// what the cell's offset from the first cell adds, which is the same for all 8.
#pragma once

#include <cstddef>

#include "simd/triangle_in_pixel.h"
#include "simd/wide_mask.h"

namespace beampipe {

// 32, 64, 128 or 256 positions.
struct PositionGrid {
  CellCounts cells;
  int cell_width = 0, cell_height = 0;  // 1/256 px
  SamplePattern first_cells;            // 16 positions, those of the first two cells of the first row

  explicit PositionGrid(int count);
  int count() const { return 8 * cells.columns * cells.rows; }
};

// masks[i] = the positions that in[i] covers, by the top-left rule. Lanes are across positions.
void position_masks(const TriangleInPixel* in, std::size_t count, const PositionGrid& grid, WideMask* masks);

// The scalar twin. Int is std::int64_t or a counting number.
template <class Int>
WideMask position_mask_scalar(const TriangleInPixelOf<Int>& in, const PositionGrid& grid) {
  WideMask mask;
  EdgeInPixel<Int> edges[3];
  Int at_position[3][8];
  for (int k = 0; k < 3; ++k) {
    edges[k] = edge_in_pixel(in, k);
    edges[k].c = edges[k].c - Int(owns_its_samples(edges[k].a, edges[k].b) ? 0 : 1);
    for (std::size_t s = 0; s < 8; ++s)
      at_position[k][s] =
          edges[k].a * Int(grid.first_cells.x[s]) + edges[k].b * Int(grid.first_cells.y[s]) + edges[k].c;
  }
  for (int cell = 0; cell < grid.cells.columns * grid.cells.rows; ++cell) {
    const Int left(cell % grid.cells.columns * grid.cell_width), top(cell / grid.cells.columns * grid.cell_height);
    Int of_cell[3];
    for (int k = 0; k < 3; ++k) of_cell[k] = edges[k].a * left + edges[k].b * top;
    for (std::size_t s = 0; s < 8; ++s) {
      bool inside = true;
      for (int k = 0; k < 3; ++k) inside &= at_position[k][s] + of_cell[k] >= Int(0);
      if (inside) mask.set(static_cast<std::size_t>(cell) * 8 + s);
    }
  }
  return mask;
}

}  // namespace beampipe
