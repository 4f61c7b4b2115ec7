// The depths at which cells are closed (stages/data/closed_depth.h), of a row of 2 x 2 quads at once: where do they
// hide a triangle, and which of them does the triangle change?
#pragma once

#include <cstddef>
#include <cstdint>

namespace beampipe {

// A triangle in a row of quads. Masks are as in QuadRow.
struct ClosingRow {
  std::uint64_t touched;     // its cells
  std::uint64_t covered;     // of these, those that it closes unless it is hidden there
  float nearest, farthest;   // its depth
  float farthest_of_closed;  // of all cells, not only these
};

struct ClosedCells {
  std::uint64_t hidden;                        // the cells with a depth < nearest
  std::uint32_t tested, hidden_count, closed;  // how many cells
  std::uint32_t changed;                       // of the closed ones, those that had a depth > farthest
  std::uint32_t changed_from_farthest;         // of these, those that had farthest_of_closed
};

// So many depths beyond the last quad that is touched must be readable and writable.
inline constexpr std::size_t kClosedSlack = 8;

// `upper`, `lower`: the depths of the two rows of cells, from the first quad on. They may be the same where the
// triangle touches no cell of the lower row. Closes what the triangle covers.
ClosedCells close_cells(const ClosingRow& row, float* upper, float* lower);

}  // namespace beampipe
