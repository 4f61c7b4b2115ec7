// The formulas of vertex_setup for one triangle, for numbers and for numbers that count (stages/cost/counting.h).
#pragma once

#include <array>

#include "simd/scalar.h"
#include "simd/vertex_transform.h"

namespace beampipe {

// Slopes of the depth plane through three snapped vertices, per pixel.
template <class Real>
struct Slopes {
  Real dzdx, dzdy;
};

template <class Real>
Slopes<Real> depth_slopes(const ScreenVertex<Real>& p, const ScreenVertex<Real>& q, const ScreenVertex<Real>& r) {
  const Real qx = q.x - p.x, qy = q.y - p.y, qz = q.z - p.z;
  const Real rx = r.x - p.x, ry = r.y - p.y, rz = r.z - p.z;
  const Real inverse = Real(1.0) / (qx * ry - rx * qy);
  return {(qz * ry - rz * qy) * inverse, (rz * qx - qz * rx) * inverse};
}

// A draw's depth bias and window_scale, as in DrawPlacement.
template <class Real>
struct DepthBiasTerms {
  Real constant, slope, clamp, window_scale;
};

// What the bias adds to a triangle's depth: glPolygonOffsetClamp's formula (OpenGL 4.6 core, section 14.6.5), whose
// slopes are those of window depth.
template <class Real>
Real depth_bias(const DepthBiasTerms<Real>& terms, Real dzdx, Real dzdy) {
  const Real zero(0.0);
  const Real steepest = greater(magnitude(dzdx), magnitude(dzdy)) / magnitude(terms.window_scale);
  const Real bias = terms.slope * steepest + terms.constant;
  const Real above = select(terms.clamp > zero, lesser(bias, terms.clamp), bias);
  return terms.window_scale * select(terms.clamp < zero, greater(above, terms.clamp), above);
}

// The bias, limited so that no vertex leaves the window depths 0 (at `window_offset`) to 1. `nearest` and `farthest`
// are those of the vertices, between these two depths.
template <class Real>
Real limited_bias(Real bias, Real nearest, Real farthest, Real window_offset, Real window_scale) {
  const Real end = window_offset + window_scale;
  const Real towards_viewer = lesser(Real(0.0), lesser(window_offset, end) - nearest);
  const Real away = greater(Real(0.0), greater(window_offset, end) - farthest);
  return lesser(greater(bias, towards_viewer), away);
}

// Twice the signed area; positive if the vertices are clockwise with y down.
template <class Int>
Int doubled_area(const std::array<Int, 3>& x, const std::array<Int, 3>& y) {
  return (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0]);
}

template <class Real>
struct Vector {
  Real x, y, z;
};

// `m`: column-major. The sums are grouped as in glm.
template <class Real>
Vector<Real> world_point(const std::array<Real, 16>& m, const Vector<Real>& p) {
  const auto row = [&](std::size_t r) { return (m[r] * p.x + m[4 + r] * p.y) + (m[8 + r] * p.z + m[12 + r]); };
  return {row(0), row(1), row(2)};
}

// The normal of a triangle, not normalized, and its length.
template <class Real>
Vector<Real> face_normal(const Vector<Real>& p, const Vector<Real>& q, const Vector<Real>& r, Real& length) {
  const Real ax = q.x - p.x, ay = q.y - p.y, az = q.z - p.z;
  const Real bx = r.x - p.x, by = r.y - p.y, bz = r.z - p.z;
  const Vector<Real> normal{ay * bz - by * az, az * bx - bz * ax, ax * by - bx * ay};
  length = square_root(normal.x * normal.x + normal.y * normal.y + normal.z * normal.z);
  return normal;
}

}  // namespace beampipe
