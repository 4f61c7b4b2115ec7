// The bytes of an aggregate as it is stored, with colour: 42. Source: slide 23 of the paper's talk.
//   coverage float32 4, mask 4, plane 3 x float32 + a fourth coefficient 16, thickness 4, z_min and z_max 8: 36;
//   colour 3 x fp16: 6.
#pragma once

#include <cstdint>

namespace beampipe {

inline constexpr std::uint32_t kAggregateVisibilityBytes = 4 + 4 + 16 + 4 + 8;
inline constexpr std::uint32_t kAggregateColorBytes = 3 * 2;
inline constexpr std::uint32_t kAggregateBytes = kAggregateVisibilityBytes + kAggregateColorBytes;

// The paper's text (section 3) has 32 bytes without colour, which is what a plane of three coefficients, all that a
// depth over a pixel needs, leaves.
inline constexpr std::uint32_t kCompactVisibilityBytes = kAggregateVisibilityBytes - 4;

// Without masks and slabs: coverage and colour; a fragment has the depth that it is sorted by as well.
inline constexpr std::uint32_t kOverBytes = 4 + kAggregateColorBytes;
inline constexpr std::uint32_t kOverFragmentBytes = kOverBytes + 4;

}  // namespace beampipe
