// Depth planes at mask positions: where one is nearer than another, and the greatest depth of one.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "simd/depth_plane.h"
#include "simd/sample_pattern.h"
#include "simd/scalar.h"

namespace beampipe {

// The positions of a pattern as the formulas take them: from the pixel's centre, in pixels.
struct PositionOffsets {
  alignas(64) std::array<float, kMaxMaskSamples> u, v;
};
std::vector<PositionOffsets> offsets_of(const std::vector<SamplePattern>& patterns);

// Bit s of masks[w]: at position s of offsets[w], `plane` is strictly nearer than `other`. Each has 32 positions. With
// `where`, only the positions in these masks are looked at; the bits of the others are 0. Lanes are across positions.
// The same bits as the formula on float, on every target.
void nearer_positions(const DepthPlane<float>& plane, const DepthPlane<float>& other, const PositionOffsets* offsets,
                      std::size_t words, std::uint32_t* masks, const std::uint32_t* where = nullptr);

inline constexpr float kNoDepth = 1.0f;  // beyond the far plane, which is at 0

// The greatest depth of `plane` over the positions in `masks`. kInFront when there are none.
inline constexpr float kInFront = -2.0f;  // nearer than every depth
float farthest_depth(const DepthPlane<float>& plane, const PositionOffsets* offsets, std::size_t words,
                     const std::uint32_t* masks);

// The sums of the coordinates of the positions in `masks`, in 1/256 px from the pixel's upper left corner.
struct PositionSums {
  std::int32_t x, y;
};
PositionSums position_sums(const SamplePattern* patterns, std::size_t words, const std::uint32_t* masks);

// The sums of their squares and of their products.
struct PositionSquares {
  std::int32_t xx, xy, yy;
};
PositionSquares position_squares(const SamplePattern* patterns, std::size_t words, const std::uint32_t* masks);

namespace scalar {
#include "simd/plane_order-inl.h"
}
using namespace scalar;

// Position s of a pattern, likewise.
inline float position_u(const SamplePattern& pattern, std::size_t s) {
  return static_cast<float>(pattern.x[s]) / kSubpixelUnits - 0.5f;
}
inline float position_v(const SamplePattern& pattern, std::size_t s) {
  return static_cast<float>(pattern.y[s]) / kSubpixelUnits - 0.5f;
}

}  // namespace beampipe
