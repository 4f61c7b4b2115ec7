// Conservative raster of a triangle over a row of cells (pixels, or parts of one): which are touched, which are covered
// as a whole. Exact.
#pragma once

#include <cstddef>
#include <cstdint>

namespace beampipe {

inline constexpr int kCellsPerRow = 32;  // bits of a row's masks

// An edge over a row of cells: its value at the cell's upper left corner, E = start + step i for cell i, and what the
// cell's deepest and shallowest corners have on top. All are integers below 2^52.
struct EdgeOverCells {
  double start, step;
  double deepest, shallowest;
};

struct CellRow {
  std::uint32_t touched, full;  // bit i: cell i
};

// The first `count` <= kCellsPerRow cells: touched where every edge is >= 0 at its deepest corner, full where every one
// is at its shallowest. Lanes are across cells.
CellRow cell_row(const EdgeOverCells (&edges)[3], std::size_t count);

// Scalar twin of one cell and one edge; Real is double or a counting number.
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
