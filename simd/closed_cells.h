// The depths at which cells are closed (stages/data/closed_depth.h), of rows of 2 x 2 quads at once: where do they hide
// a triangle, and which of them does the triangle change?
#pragma once

#include <cstddef>
#include <cstdint>

namespace beampipe {

// A row of quads, of which the first one begins at cell (x, y). Masks are as in QuadRow.
struct ClosingRow {
  std::int32_t x, y;
  std::uint64_t visible;  // cells that the triangle touches; later those of them where it is not hidden
  std::uint64_t full;     // cells that it covers
};

struct ClosingTriangle {
  float nearest, farthest;
  bool closes;  // the cells that it covers and where it is not hidden
};

// A tile's cells.
struct ClosedTile {
  std::int32_t x0, y0, x1, y1;
  float* depths;   // row by row; kClosedSlack more must be readable and writable
  float farthest;  // of them
};
inline constexpr std::size_t kClosedSlack = 8;

// How many cells.
struct ClosedCells {
  std::uint32_t tested;
  std::uint32_t hidden;  // they have a depth < nearest
  std::uint32_t closed;
  std::uint32_t changed;                // of the closed ones, those that had a depth > farthest
  std::uint32_t changed_from_farthest;  // of these, those that had the tile's farthest depth
};

// Leaves of each row the visible cells.
ClosedCells close_cells(const ClosingTriangle& triangle, const ClosedTile& tile, ClosingRow* rows, std::size_t count);

}  // namespace beampipe
