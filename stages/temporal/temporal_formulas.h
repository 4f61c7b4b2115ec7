// The formulas of motion and temporal, for numbers and for numbers that count (stages/cost/counting.h).
#pragma once

#include "simd/scalar.h"

namespace beampipe {

// ---- motion ----

// Transforms a point at (x, y) in normalized device coordinates and at clip-space depth z to its position in the last
// frame, in pixels. `m`: to_last_frame's matrix, column-major. `w` is positive in front of the eye.
template <class Real>
void reproject(const Real m[16], Real x, Real y, Real z, Real width, Real height, Real& last_x, Real& last_y, Real& w) {
  const auto row = [&](int r) { return m[r] * x + m[4 + r] * y + m[8 + r] * z + m[12 + r]; };
  const Real one(1.0f), half(0.5f);
  w = row(3);
  const Real inverse = one / w;
  last_x = (row(0) * inverse + one) * half * width;
  last_y = (one - row(1) * inverse) * half * height;
}

// Finds the vector from a pixel's centre to where the surface there was, in pixels. Returns whether that was in front
// of the eye.
template <class Real>
bool move(const Real m[16], Real center_x, Real center_y, Real depth, Real width, Real height, Real& dx, Real& dy) {
  const Real zero(0.0), one(1.0), two(2.0);
  Real x, y, w;
  reproject(m, two * center_x / width - one, one - two * center_y / height, two * lesser(depth, zero) + one, width,
            height, x, y, w);
  dx = x - center_x, dy = y - center_y;
  return w > zero;
}

template <class Real>
Real square_length(Real x, Real y) {
  return x * x + y * y;
}

// ---- temporal ----

// One channel: the history's four texels are weighted, clamped to the box as far as `clamped` (0..1) says, and blended
// with the new colour.
template <class Real>
Real blend_channel(const Real texels[4], const Real weights[4], Real low, Real high, Real clamped, Real color,
                   Real blend) {
  const Real old = texels[0] * weights[0] + texels[1] * weights[1] + texels[2] * weights[2] + texels[3] * weights[3];
  const Real in_box = greater(low, lesser(high, old));
  const Real kept = old + (in_box - old) * clamped;
  return kept + (color - kept) * blend;
}

// The bilinear weights of the four texels around (x, y). (left, top) is the first of them. All are in texels.
template <class Real>
void texel_weights(Real x, Real y, Real left, Real top, Real weights[4]) {
  const Real one(1.0f), half(0.5f);
  const Real fx = x - half - left, fy = y - half - top, rest_x = one - fx, rest_y = one - fy;
  weights[0] = rest_x * rest_y, weights[1] = fx * rest_y, weights[2] = rest_x * fy, weights[3] = fx * fy;
}

// The part of the clamp that applies, 0..1: it grows with the speed up to `still_px`.
template <class Real>
Real clamp_by_speed(Real speed, Real still_px) {
  return lesser(speed / still_px, Real(1.0f));
}

}  // namespace beampipe
