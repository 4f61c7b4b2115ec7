// Conservative rasterization of two rows of cells, which are pixels or parts of a pixel: which cells a triangle
// touches, and which it covers completely. Exact.
#pragma once

#include <cstddef>
#include <cstdint>

namespace beampipe {

inline constexpr int kCellsPerRow = 32;  // bits of a row's masks

// An edge over rows of cells. Its value at the upper left corner of cell i of row j is start + step i + down j.
// `deepest` and `shallowest` are what the value gains from there to the corner of the cell where it is greatest and
// where it is least. All values are integers below 2^52.
struct EdgeOverCells {
  double start, step, down;
  double deepest, shallowest;
};

struct CellRow {
  std::uint32_t touched, full;  // bit i: cell i
};

struct CellRows {
  CellRow rows[2];
};

// Tests the first `count` cells of both rows, 1..kCellsPerRow. A cell is touched if every edge is >= 0 at the cell's
// deepest corner, and full if every edge is >= 0 at its shallowest corner. Eight lanes are four cells of both rows,
// because most triangles are small.
CellRows cell_rows(const EdgeOverCells (&edges)[3], std::size_t count);

// The scalar twin for one cell and one edge. `corner` is the edge's value at the upper left corner. Real is double or a
// counting number.
template <class Real>
void cell_against_edge(Real corner, Real deepest, Real shallowest, bool& touched, bool& full) {
  touched &= corner + deepest >= Real(0.0);
  full &= corner + shallowest >= Real(0.0);
}

inline CellRows cell_rows_scalar(const EdgeOverCells (&edges)[3], std::size_t count) {
  CellRows result{};
  for (int j = 0; j < 2; ++j) {
    for (std::size_t i = 0; i < count; ++i) {
      bool touched = true, full = true;
      for (const EdgeOverCells& edge : edges)
        cell_against_edge(edge.start + edge.step * static_cast<double>(i) + edge.down * j, edge.deepest,
                          edge.shallowest, touched, full);
      result.rows[j].touched |= std::uint32_t{touched} << i;
      result.rows[j].full |= std::uint32_t{touched && full} << i;
    }
  }
  return result;
}

}  // namespace beampipe
