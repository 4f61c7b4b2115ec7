// Which samples of a pixel, or of a cell of a pixel, a triangle covers. The edge tests are exact.
#pragma once

#include <cstddef>
#include <cstdint>

#include "simd/sample_pattern.h"

namespace beampipe {

// The three edges of a triangle, seen from a cell's upper left corner. Sample (x, y), in 1/256 px, is covered if
// a[k] x + b[k] y + c[k] >= 0 for k = 0, 1, 2. The top-left rule is already in c, which is one less for edges that do
// not own their samples. |a|, |b| <= 2^24, |c| < 2^52.
struct CellEdges {
  std::int32_t a[3], b[3];
  std::int64_t c[3];
};

// Bit s of masks[i]: cells[i] covers sample s of the pattern. Lanes are across samples.
void sample_masks(const CellEdges* cells, std::size_t count, const SamplePattern& pattern, std::uint32_t* masks);

// A triangle's edges over a grid of cells, with the top-left rule. Edge k has the value a[k] x + b[k] y + right[k] i +
// down[k] j + start[k] at sample (x, y) of cell (i, j). All terms are integers below 2^50.
struct GridEdges {
  double a[3], b[3], right[3], down[3], start[3];
};

struct GridCell {
  std::uint32_t edges;  // index of the triangle's edges; cells of one triangle follow each other
  std::int32_t x, y;
};

// The same for cells of a grid. Returns how many samples are covered.
std::uint64_t sample_masks(const GridEdges* edges, const GridCell* cells, std::size_t count,
                           const SamplePattern& pattern, std::uint32_t* masks);

// The scalar twin. Int is std::int64_t or a counting number.
template <class Int>
std::uint32_t sample_mask_scalar(const Int a[3], const Int b[3], const Int c[3], const SamplePattern& pattern) {
  std::uint32_t mask = 0;
  for (int s = 0; s < pattern.count; ++s) {
    const auto i = static_cast<std::size_t>(s);
    bool inside = true;
    for (int k = 0; k < 3; ++k) inside &= a[k] * Int(pattern.x[i]) + b[k] * Int(pattern.y[i]) + c[k] >= Int(0);
    mask |= static_cast<std::uint32_t>(inside) << s;
  }
  return mask;
}

}  // namespace beampipe
