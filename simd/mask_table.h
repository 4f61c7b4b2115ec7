// Localization masks by table: the half-plane on one side of an edge, looked up by the edge's direction and distance.
// Source: Waller et al. 2000, "Efficient coverage mask generation for antialiasing"; a 64 x 64 (theta, r) table of
// 32-bit words, 16 KB (slide 8 of the paper's talk).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "simd/sample_pattern.h"

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
struct TableEdge {
  std::int32_t angle;  // 0..31, of the unflipped edge
  std::uint32_t flip;  // 0, or ~0 when the edge runs the other way: entry [angle + 32][63 - r]
  float distance;      // of the unflipped edge from the pixel's centre, px; positive: the centre is inside
};

struct TableTriangle {
  TableEdge edges[3];
};

// The table's angle for an edge with inward normal (a, b), not both 0.
std::int32_t table_angle(double a, double b, bool& flip);

// masks[i] = AND of the three edges' look-ups. Lanes are across triangles.
void table_masks(const TableTriangle* triangles, std::size_t count, const MaskTable& table, std::uint32_t* masks);

// Scalar twin; distances beyond the half diagonal give no or all samples.
inline std::uint32_t table_mask_scalar(const TableTriangle& triangle, const MaskTable& table) {
  std::uint32_t mask = ~0u;
  for (const TableEdge& edge : triangle.edges) {
    const float scaled = (edge.distance * (1.0f / kHalfDiagonal) + 1.0f) * (kTableDistances / 2);
    const float clamped = scaled < 0.0f ? 0.0f : (scaled > kTableDistances - 1 ? kTableDistances - 1 : scaled);
    const auto r = static_cast<std::int32_t>(clamped);
    std::uint32_t word =
        edge.flip ? table.words()[(edge.angle + kTableAngles / 2) * kTableDistances + kTableDistances - 1 - r]
                  : table.words()[edge.angle * kTableDistances + r];
    if (edge.distance <= -kHalfDiagonal) word = edge.flip;
    if (edge.distance >= kHalfDiagonal) word = ~edge.flip;
    mask &= word;
  }
  return mask;
}

}  // namespace beampipe
