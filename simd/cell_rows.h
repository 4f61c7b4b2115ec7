// Conservative rasterization of a row of cells, which are pixels or parts of a pixel: which cells a triangle touches,
// and which it covers completely. Exact.
#pragma once

#include <cstddef>
#include <cstdint>

namespace beampipe {

inline constexpr int kCellsPerRow = 32;  // bits of a row's masks

// An edge over a row of cells. Its value at the upper left corner of cell i is start + step i. `deepest` and
// `shallowest` are what the value gains from there to the corner of the cell where it is greatest and where it is
// least. All values are integers below 2^52.
struct EdgeOverCells {
  double start, step;
  double deepest, shallowest;
};

struct CellRow {
  std::uint32_t touched, full;  // bit i: cell i
};

// Tests the first `count` cells, 1..kCellsPerRow. A cell is touched if every edge is >= 0 at the cell's deepest corner,
// and full if every edge is >= 0 at its shallowest corner. Lanes are across cells.
CellRow cell_row(const EdgeOverCells (&edges)[3], std::size_t count);

// The scalar twin for one cell and one edge. `corner` is the edge's value at the upper left corner. Real is double or a
// counting number.
template <class Real>
void cell_against_edge(Real corner, Real deepest, Real shallowest, bool& touched, bool& full) {
  touched &= corner + deepest >= Real(0.0);
  full &= corner + shallowest >= Real(0.0);
}

inline CellRow cell_row_scalar(const EdgeOverCells (&edges)[3], std::size_t count) {
  CellRow row{};
  for (std::size_t i = 0; i < count; ++i) {
    bool touched = true, full = true;
    for (const EdgeOverCells& edge : edges)
      cell_against_edge(edge.start + edge.step * static_cast<double>(i), edge.deepest, edge.shallowest, touched, full);
    row.touched |= std::uint32_t{touched} << i;
    row.full |= std::uint32_t{touched && full} << i;
  }
  return row;
}

}  // namespace beampipe
