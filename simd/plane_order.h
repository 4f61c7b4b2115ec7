// Depth planes against each other, position by position: which of two is nearer, and how near one comes.
#pragma once

#include <cstddef>
#include <cstdint>

#include "simd/merge.h"
#include "simd/sample_pattern.h"

namespace beampipe {

// Bit s of masks[w]: at position s of patterns[w], `plane` is strictly nearer than `other`. Each pattern has 32
// positions. Lanes are across positions; the same bits as the scalar twin on every target.
void nearer_positions(const DepthPlane<float>& plane, const DepthPlane<float>& other, const SamplePattern* patterns,
                      std::size_t words, std::uint32_t* masks);

// The least depth of `plane` over the positions in `masks`; kNoDepth when there are none.
inline constexpr float kNoDepth = 1.0f;  // beyond the far plane, which is at 0
float nearest_depth(const DepthPlane<float>& plane, const SamplePattern* patterns, std::size_t words,
                    const std::uint32_t* masks);

// ---- Scalar twins of one position; u and v from the pixel's centre, in pixels ----

template <class Float>
bool nearer_scalar(const DepthPlane<Float>& plane, const DepthPlane<Float>& other, Float u, Float v) {
  return depth_at(plane, u, v) < depth_at(other, u, v);
}

template <class Float>
Float nearest_scalar(const DepthPlane<Float>& plane, Float u, Float v, bool in_mask, Float nearest) {
  return select(in_mask, lesser(nearest, depth_at(plane, u, v)), nearest);
}

// Position s of a pattern as the twins take it.
inline float position_u(const SamplePattern& pattern, std::size_t s) {
  return static_cast<float>(pattern.x[s]) / kSubpixelUnits - 0.5f;
}
inline float position_v(const SamplePattern& pattern, std::size_t s) {
  return static_cast<float>(pattern.y[s]) / kSubpixelUnits - 0.5f;
}

}  // namespace beampipe
