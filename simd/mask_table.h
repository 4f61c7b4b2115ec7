// Localization masks by table: the half-plane on one side of an edge, looked up by the edge's direction and distance.
// Source: Waller et al. 2000, "Efficient coverage mask generation for antialiasing"; a 64 x 64 (theta, r) table of
// 32-bit words, 16 KB (slide 8 of the paper's talk).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "simd/sample_pattern.h"
#include "simd/scalar.h"

namespace beampipe {

inline constexpr int kTableAngles = 64;     // over the full circle
inline constexpr int kTableDistances = 64;  // over [-1/sqrt(2), 1/sqrt(2)] px, signed distance from the pixel's centre
inline constexpr float kHalfDiagonal = 0.70710678f;  // px: beyond it an edge does not cut the pixel

// Entry [theta][r]: the samples with n(theta) . (sample - centre) + r >= 0. Entry [theta + pi][-r] is the complement,
// so the masks of an edge and of its reverse share no bit and miss none.
class MaskTable {
 public:
  explicit MaskTable(const SamplePattern& pattern);  // 32 samples
  const std::uint32_t* words() const { return words_.data(); }

 private:
  alignas(64) std::array<std::uint32_t, kTableAngles * kTableDistances> words_{};
};

// An edge as the table sees it. Both directions of an edge give the same angle and distance, one of them flipped, so
// that rounding cannot put them into entries that are not each other's complement.
template <class Int, class Mask, class Float>
struct TableEdgeOf {
  Int angle;       // 0..31, of the unflipped edge
  Mask flip;       // 0, or ~0 when the edge runs the other way: entry [angle + 32][63 - r]
  Float distance;  // of the unflipped edge from the pixel's centre, px; positive: the centre is inside
};
using TableEdge = TableEdgeOf<std::int32_t, std::uint32_t, float>;

template <class Int, class Mask, class Float>
struct TableTriangleOf {
  TableEdgeOf<Int, Mask, Float> edges[3];
};
using TableTriangle = TableTriangleOf<std::int32_t, std::uint32_t, float>;

// The table's angle for an edge with inward normal (a, b), not both 0.
std::int32_t table_angle(double a, double b, bool& flip);

// masks[i] = AND of the three edges' look-ups. Lanes are across triangles.
void table_masks(const TableTriangle* triangles, std::size_t count, const MaskTable& table, std::uint32_t* masks);

// Scalar twin, also for counting numbers; distances beyond the half diagonal give no or all samples.
template <class Int, class Mask, class Float>
Mask table_mask_scalar(const TableTriangleOf<Int, Mask, Float>& triangle, const MaskTable& table) {
  const Float zero(0.0f), one(1.0f), reach(kHalfDiagonal);
  Mask mask(~0u);
  for (const TableEdgeOf<Int, Mask, Float>& edge : triangle.edges) {
    const Float scaled = (edge.distance * Float(1.0f / kHalfDiagonal) + one) * Float(kTableDistances / 2);
    const Int column = to_integer(lesser(greater(scaled, zero), Float(kTableDistances - 1)));
    const Int row = edge.angle * Int(kTableDistances);
    const Int reverse = row + Int((kTableAngles / 2 + 1) * kTableDistances - 1) - column;
    Mask word = fetch(table.words(), select(edge.flip != Mask(0u), reverse, row + column));
    word = select(edge.distance <= zero - reach, edge.flip, word);
    word = select(edge.distance >= reach, ~edge.flip, word);
    mask = mask & word;
  }
  return mask;
}
inline std::uint32_t table_mask_scalar(const TableTriangle& triangle, const MaskTable& table) {
  return table_mask_scalar<std::int32_t, std::uint32_t, float>(triangle, table);
}

}  // namespace beampipe
