// A triangle as one pixel or cell of it sees it: the arithmetic in front of the kernels, for numbers and for counting
// numbers. Int is std::int64_t, Float float, Real double, or each a counting number.
#pragma once

#include <cstdint>

#include "simd/coverage.h"
#include "simd/sample_pattern.h"
#include "simd/scalar.h"

namespace beampipe {

inline constexpr float kUnit = 1.0f / kSubpixelUnits;  // px

// An edge's value at (x, y) in 1/256 px: a x + b y + c.
template <class Int>
struct EdgeAt {
  Int a, b, c;
  Int at(Int x, Int y) const { return a * x + b * y + c; }
};

// All of a pixel's coverage input but depth. Its upper left corner is (left, top), in 1/256 px.
template <class Int, class Float>
void set_geometry(const Int x[3], const Int y[3], const EdgeAt<Int> edges[3], Int left, Int top,
                  CoverageInput<Float>& in) {
  const Float unit(kUnit), unit_area(kUnit * kUnit);
  const Int corners_x[2] = {left, left + Int(kSubpixelUnits)}, corners_y[2] = {top, top + Int(kSubpixelUnits)};
  for (int k = 0; k < 3; ++k) {
    in.u[k] = to_float(x[k] - left) * unit;
    in.v[k] = to_float(y[k] - top) * unit;
    in.a[k] = to_float(edges[k].a) * unit;
    in.b[k] = to_float(edges[k].b) * unit;
    for (int corner = 0; corner < 4; ++corner)
      in.corner[k][corner] = to_float(edges[k].at(corners_x[corner & 1], corners_y[corner >> 1])) * unit_area;
  }
}

// Depth at (x, y), in pixels.
template <class Real>
Real plane_at(Real z, Real dzdx, Real dzdy, Real anchor_x, Real anchor_y, Real x, Real y) {
  return z + dzdx * (x - anchor_x) + dzdy * (y - anchor_y);
}

// A triangle's depth plane as the samples of one cell see it: depth at the cell's corner (x, y), in pixels, and slopes
// per 1/256 px.
template <class Real, class Float>
void cell_plane(Real z, Real dzdx, Real dzdy, Real anchor_x, Real anchor_y, Real x, Real y, Float& depth,
                Float& slope_x, Float& slope_y) {
  const Real unit(1.0 / kSubpixelUnits);
  depth = to_float(plane_at(z, dzdx, dzdy, anchor_x, anchor_y, x, y));
  slope_x = to_float(dzdx * unit), slope_y = to_float(dzdy * unit);
}

// Edge values at the pixel's upper left corner, with the top-left rule.
template <class Int>
Int owned_edge(const EdgeAt<Int>& edge, Int left, Int top, Int not_owned) {
  return edge.at(left, top) - not_owned;
}

// Of an edge from (x, y), in pixels: `per_unit` is 1 / its length in 1/256 px, in pixels.
template <class Int, class Real>
auto edge_distance(const EdgeAt<Int>& edge, Int x, Int y, Real per_unit) {
  return to_float(to_double(edge.at(x, y)) * per_unit);
}

}  // namespace beampipe
