// The formulas of vertex_setup for one triangle, for numbers and for numbers that count (stages/cost/counting.h). Those
// that run on several triangles at once are in simd/triangle_setup.h.
#pragma once

#include <array>

#include "simd/scalar.h"
#include "simd/triangle_setup.h"

namespace beampipe {

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

// Of a plane through p, at another place.
template <class Real>
Real value_beside(const ScreenVertex<Real>& p, const Slopes<Real>& slopes, Real x, Real y) {
  return p.z + slopes.dzdx * (x - p.x) + slopes.dzdy * (y - p.y);
}

// Twice the signed area; positive if the vertices are clockwise with y down.
template <class Number>
Number doubled_area(const std::array<Number, 3>& x, const std::array<Number, 3>& y) {
  return (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0]);
}

}  // namespace beampipe
