// The formulas of motion and temporal, for numbers and for numbers that count (stages/cost/counting.h).
#pragma once

#include "simd/scalar.h"

namespace beampipe {

// ---- motion ----

// From one frame's screen to that of the last frame.
template <class Real>
struct Reprojection {
  Real m[16];          // to_last_frame's matrix, column-major
  Real width, height;  // pixels
};

// A position in the last frame, in pixels. `w` is positive in front of the eye.
template <class Real>
struct LastPosition {
  Real x, y, w;
};

// (x, y): normalized device coordinates; `z`: clip-space depth.
template <class Real>
LastPosition<Real> reproject(const Reprojection<Real>& to_last, Real x, Real y, Real z) {
  const auto& m = to_last.m;
  const auto row = [&](int r) { return m[r] * x + m[4 + r] * y + m[8 + r] * z + m[12 + r]; };
  const Real one(1.0f), half(0.5f);
  const Real w = row(3), inverse = one / w;
  return {(row(0) * inverse + one) * half * to_last.width, (one - row(1) * inverse) * half * to_last.height, w};
}

// The vector from a pixel's centre to where the surface there was in the last frame, in pixels.
template <class Real>
struct Movement {
  Real dx, dy;
  bool in_front;  // it was in front of the eye
};

template <class Real>
Movement<Real> movement(const Reprojection<Real>& to_last, Real center_x, Real center_y, Real depth, Real farthest) {
  const Real zero(0.0), one(1.0), two(2.0);
  const LastPosition<Real> last = reproject(to_last, two * center_x / to_last.width - one,
                                            one - two * center_y / to_last.height, two * lesser(depth, farthest) + one);
  return {last.x - center_x, last.y - center_y, last.w > zero};
}

// A point in clip space; depth is not needed.
template <class Real>
struct ClipPoint {
  Real x, y, w;
};

// A vertex in clip space. `m`: a column-major matrix from the vertex's space.
template <class Real>
ClipPoint<Real> in_clip(const Real m[16], Real x, Real y, Real z) {
  const auto row = [&](int r) { return m[r] * x + m[4 + r] * y + m[8 + r] * z + m[12 + r]; };
  return {row(0), row(1), row(3)};
}

template <class Real>
ClipPoint<Real> cross(const ClipPoint<Real>& a, const ClipPoint<Real>& b) {
  return {a.y * b.w - a.w * b.y, a.w * b.x - a.x * b.w, a.x * b.y - a.y * b.x};
}

template <class Real>
Real dot(const ClipPoint<Real>& a, const ClipPoint<Real>& b) {
  return a.x * b.x + a.y * b.y + a.w * b.w;
}

// As movement, of a triangle whose vertices have moved: the pixel's centre is the sum of the vertices by three weights,
// and so was what it shows. The plane of a triangle that is seen edge-on has no weights, and counts as behind the eye.
template <class Real>
Movement<Real> vertex_movement(const ClipPoint<Real> now[3], const ClipPoint<Real> before[3], Real width, Real height,
                               Real center_x, Real center_y) {
  const Real zero(0.0), one(1.0), two(2.0), half(0.5);
  const ClipPoint<Real> center{two * center_x / width - one, one - two * center_y / height, one};
  const ClipPoint<Real> normals[3] = {cross(now[1], now[2]), cross(now[2], now[0]), cross(now[0], now[1])};
  const Real inverse = one / dot(now[0], normals[0]);
  const Real weights[3] = {dot(normals[0], center) * inverse, dot(normals[1], center) * inverse,
                           dot(normals[2], center) * inverse};
  const auto sum = [&](Real ClipPoint<Real>::*part) {
    return before[0].*part * weights[0] + before[1].*part * weights[1] + before[2].*part * weights[2];
  };
  const Real w = sum(&ClipPoint<Real>::w), per_w = one / w;
  return {(sum(&ClipPoint<Real>::x) * per_w + one) * half * width - center_x,
          (one - sum(&ClipPoint<Real>::y) * per_w) * half * height - center_y, w > zero};
}

template <class Real>
Real square_length(Real x, Real y) {
  return x * x + y * y;
}

// ---- temporal ----

// The least and the greatest value of a channel around a pixel.
template <class Real>
struct ChannelBox {
  Real low, high;
};

// One channel of the history, from its four texels.
template <class Real>
Real filtered(const Real texels[4], const Real weights[4]) {
  return texels[0] * weights[0] + texels[1] * weights[1] + texels[2] * weights[2] + texels[3] * weights[3];
}

// One channel: the history is clamped to the box as far as `clamped` (0..1) says, and blended with the new colour.
template <class Real>
Real blend_channel(Real old, const ChannelBox<Real>& box, Real clamped, Real color, Real blend) {
  const Real in_box = greater(box.low, lesser(box.high, old));
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

template <class Real>
ChannelBox<Real> widened(const ChannelBox<Real>& box, Real deviation, Real deviations) {
  const Real reach = deviation * deviations;
  return {box.low - reach, box.high + reach};
}

// The standard deviation of a channel's values after one more, which is `step` away from their mean and weighs
// `weight`.
template <class Real>
Real next_deviation(Real deviation, Real step, Real weight) {
  return square_root((Real(1.0f) - weight) * (deviation * deviation + weight * (step * step)));
}

}  // namespace beampipe
