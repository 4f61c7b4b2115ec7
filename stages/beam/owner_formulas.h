// Formulas of compose_owners. Float may be a number that counts.
#pragma once

#include "simd/depth_plane.h"
#include "simd/plane_gap.h"
#include "simd/plane_order.h"
#include "simd/scalar.h"
#include "stages/beam/specks.h"
#include "stages/data/mix_bits.h"

namespace beampipe {

// The distance in depth of two planes at (u, v), in pixels from the pixel's centre.
template <class Float>
Float depth_gap(const DepthPlane<Float>& plane, const DepthPlane<Float>& other, Float u, Float v) {
  return magnitude(depth_at(plane, u, v) - depth_at(other, u, v));
}

// Does a speck at (u, v) with this depth lie in front of a surface or, as part of a smooth one, hardly behind it?
template <class Float>
bool is_on_or_before(Float depth, const DepthPlane<Float>& surface, Float u, Float v) {
  return depth <= depth_at(surface, u, v) + Float(kSurfaceReach) * (magnitude(surface.dzdu) + magnitude(surface.dzdv));
}

// How far the analytic estimate of a pixel may be from the count of its positions: in positions for areas; for colours,
// in positions of the brighter one of the two mean colours. An edge through a grid of 256 positions leaves the count
// wrong by one position, as a standard deviation.
inline constexpr float kAreaTolerance = 2.0f, kColorTolerance = 3.0f;

template <class Float>
struct Estimate {
  Float area;      // 0..1
  Float color[3];  // linear RGB times area
};

// The analytic estimate, moved towards the counted one as far as the tolerances demand. `analytic.area` is above 0.
template <class Float>
Estimate<Float> limited_estimate(const Estimate<Float>& analytic, const Estimate<Float>& counted, Float positions) {
  const Float zero(0.0f), one(1.0f);
  const auto limited = [](Float x, Float middle, Float tolerance) {
    return lesser(greater(x, middle - tolerance), middle + tolerance);
  };
  Estimate<Float> result;
  result.area = select(counted.area == one, one,
                       lesser(limited(analytic.area, counted.area, Float(kAreaTolerance) / positions), one));
  const Float scale = result.area / analytic.area;
  Float brightest = zero;
  for (int c = 0; c < 3; ++c) {
    brightest = greater(brightest, analytic.color[c] / analytic.area);
    brightest = greater(brightest,
                        select(counted.area > zero, counted.color[c] / greater(counted.area, one / positions), zero));
  }
  const Float tolerance = Float(kColorTolerance) / positions * brightest;
  for (int c = 0; c < 3; ++c) result.color[c] = limited(scale * analytic.color[c], counted.color[c], tolerance);
  return result;
}

// Where sums round what a surface adds: a number above 0 and up to 1 that differs between surfaces. It depends on
// `content`, what the surface is, and not on the order of triangles. Its eight bits are exact in the sum of a float and
// the largest addend.
template <class Bits>
auto rounding_threshold(Bits content) {
  using Float = decltype(to_float(mix_bits(content)));
  return (to_float(mix_bits(content) >> 24) + Float(1.0f)) * Float(0x1p-8f);
}

}  // namespace beampipe
