// Which mask positions of a pixel a triangle covers: exact integer edge tests, as msaa:N does for its samples.
//
// The positions (simd/sample_pattern.h, cell_patterns) are the same 8 in every cell of a grid. An edge value at a
// position is its value at the position's place in the first cells, which is computed once, and what the cell's place
// adds, which eight positions share.
#pragma once

#include <cstddef>

#include "simd/pixel_triangle.h"
#include "simd/wide_mask.h"

namespace beampipe {

// 32, 64, 128 or 256 positions.
struct PositionGrid {
  CellCounts cells;
  int cell_width = 0, cell_height = 0;  // 1/256 px
  SamplePattern first_cells;            // the positions of the first two cells of the first row

  explicit PositionGrid(int count);
  int count() const { return 8 * cells.columns * cells.rows; }
};

// masks[i] = positions that in[i] covers, by the top-left rule. Lanes are across positions.
void position_masks(const TriangleInPixel* in, std::size_t count, const PositionGrid& grid, WideMask* masks);

// Scalar twin; Int is std::int64_t or a counting number.
template <class Int>
WideMask position_mask_scalar(const PixelTriangleOf<Int>& in, const PositionGrid& grid) {
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
