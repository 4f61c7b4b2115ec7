// Localization masks by table lookup: the half-plane on the inside of an edge, found by the edge's direction and its
// distance from the pixel's centre.
// Source: Waller et al. 2000, "Efficient coverage mask generation for antialiasing"; a (theta, r) table of 32-bit
// words, 16 KB (slide 8 of the talk on Crassin et al. 2018). Its 32 x 128 entries are a choice: of the shapes of that
// size, the one with the least error. An edge and its reverse share an entry.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "simd/sample_pattern.h"
#include "simd/scalar.h"

namespace beampipe {

inline constexpr int kTableAngles = 32;      // over half a circle
inline constexpr int kTableDistances = 128;  // over [-1/sqrt(2), 1/sqrt(2)] px, signed distance from the pixel's centre
inline constexpr float kHalfDiagonal = 0.70710678f;  // px: beyond it an edge does not cut the pixel

// Entry [theta][r] is the set of samples with n(theta) . (sample - centre) + r >= 0, for angles that are multiples of
// pi / 32, so that upright and level edges are exact but for their distance. The reverse of an edge has the complement,
// so every sample is in the mask of either.
class MaskTable {
 public:
  explicit MaskTable(const SamplePattern& pattern);  // which has 32 samples
  const std::uint32_t* words() const { return words_.data(); }

 private:
  alignas(64) std::array<std::uint32_t, kTableAngles * kTableDistances> words_{};
};

// An edge as the table sees it. An edge and its reverse have the same angle and distance, and only one of them is
// flipped, so that rounding cannot lead them to entries that are not complements of each other.
template <class Int, class Mask, class Float>
struct TableEdgeOf {
  Int angle;       // 0..31, of the unflipped edge
  Mask flip;       // 0, or ~0 if the edge runs the other way: its mask is the complement
  Float distance;  // of the unflipped edge from the pixel's centre, px; positive if the centre is inside
};
using TableEdge = TableEdgeOf<std::int32_t, std::uint32_t, float>;

template <class Int, class Mask, class Float>
struct TableTriangleOf {
  TableEdgeOf<Int, Mask, Float> edges[3];
};
using TableTriangle = TableTriangleOf<std::int32_t, std::uint32_t, float>;

// The table's angle that is nearest to that of an edge with the inward normal (a, b), which are not both 0, and whether
// the edge is flipped.
std::int32_t table_angle(double a, double b, bool& flip);

// masks[i] = the samples inside all three edges of triangles[i], by the table. Lanes are across triangles. The same
// bits as the formula on float, on every target.
void table_masks(const TableTriangle* triangles, std::size_t count, const MaskTable& table, std::uint32_t* masks);

namespace scalar {
#include "simd/mask_table-inl.h"
}
using namespace scalar;

inline std::uint32_t table_mask_formula(const TableTriangle& triangle, const MaskTable& table) {
  return table_mask_formula<std::int32_t, std::uint32_t, float>(triangle, table);
}

}  // namespace beampipe
