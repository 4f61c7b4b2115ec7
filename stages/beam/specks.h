// Specks: fragments that cover no mask position.
#pragma once

#include <cstdint>
#include <vector>

#include "simd/depth_plane.h"
#include "simd/sample_pattern.h"
#include "simd/scalar.h"
#include "simd/wide_mask.h"
#include "stages/data/fragment_geometry.h"

namespace beampipe {

// A speck of a smooth surface counts as part of the surface that owns a position next to it, if it lies at most this
// far behind that surface, in pixels of the surface's slope: a quarter of the distance between positions of a 256-bit
// mask.
inline constexpr float kSurfaceReach = 1.0f / 64.0f;

// Does a speck at (u, v), in pixels from the pixel's centre, lie in front of a surface or, as part of a smooth one,
// hardly behind it?
template <class Float>
bool is_on_or_before(Float depth, const DepthPlane<Float>& surface, Float u, Float v) {
  return depth <= depth_at(surface, u, v) + Float(kSurfaceReach) * (magnitude(surface.dzdu) + magnitude(surface.dzdv));
}

// All specks that have the same nearest position may together cover at most this many times a position's share of the
// pixel; if they cover more, they are several layers. About twice a position's share is nearer to it than to any other
// position. Four times is enough not to affect dense meshes.
inline constexpr float kSpeckShares = 4.0f;

// The search for the free position that is nearest to (u, v), in pixels. Float and Index may be numbers that count.
template <class Float, class Index>
struct NearestPosition {
  Float u, v;
  Float least;  // square of the distance so far
  Index position;

  void look_at(Float x, Float y, bool is_free, Index index) {
    const Float du = x - u, dv = y - v;
    const Float distance = du * du + dv * dv;
    const bool nearer = (distance < least) & is_free;
    least = select(nearer, distance, least);
    position = select(nearer, index, position);
  }
};

// The position that is nearest to (u, v), of those that are not `taken`.
inline std::size_t nearest_position(const std::vector<SamplePattern>& positions, float u, float v,
                                    const WideMask& taken) {
  constexpr float kFar = 4.0f;  // more than the square of the pixel's diagonal
  NearestPosition<float, std::uint32_t> search{u, v, kFar, 0};
  for (std::uint32_t i = 0; i < positions.size() * kMaxMaskSamples; ++i) {
    const SamplePattern& pattern = positions[i / kMaxMaskSamples];
    const std::size_t s = i % kMaxMaskSamples;
    search.look_at(static_cast<float>(pattern.x[s]) * kUnit, static_cast<float>(pattern.y[s]) * kUnit, !taken.test(i),
                   i);
  }
  return search.position;
}

}  // namespace beampipe
