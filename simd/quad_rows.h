// Conservative rasterization of rows of 2 x 2 quads of cells, which are pixels or parts of a pixel: which cells a
// triangle touches, and which it covers completely. Exact.
#pragma once

#include <cstddef>
#include <cstdint>

namespace beampipe {

inline constexpr int kQuadsPerRow = 16;  // four bits of a row's masks each

// An edge over cells. Its value at the upper left corner of cell i of row j is start + step i + down j. `deepest` and
// `shallowest` are what the value gains from there to the corner of the cell where it is greatest and where it is
// least. All values are integers below 2^52.
struct EdgeOverCells {
  double start, step, down;
  double deepest, shallowest;
};

// Bit 4 q + 2 j + i: cell i of row j in quad q.
struct QuadRow {
  std::uint64_t touched, full;
};

// Tests all cells of `rows` rows of `quads` quads, 1..kQuadsPerRow. The first quad has the cells 0 and 1 of the rows 0
// and 1. A cell is touched if every edge is >= 0 at the cell's deepest corner, and full if every edge is >= 0 at its
// shallowest corner. Eight lanes are two quads, because most triangles are small.
void quad_rows(const EdgeOverCells (&edges)[3], std::size_t quads, std::size_t rows, QuadRow* out);

// The scalar twin for one cell and one edge. `corner` is the edge's value at the upper left corner. Real is double or a
// counting number.
template <class Real>
void cell_against_edge(Real corner, Real deepest, Real shallowest, bool& touched, bool& full) {
  touched &= corner + deepest >= Real(0.0);
  full &= corner + shallowest >= Real(0.0);
}

}  // namespace beampipe
