// A triangle as one pixel or cell of it sees it: the arithmetic in front of the kernels, for numbers and for counting
// numbers. Int is std::int64_t, Float float, Real double, or each a counting number.
#pragma once

#include <cstdint>

#include "simd/depth_range.h"
#include "simd/pixel_triangle.h"
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

// The triangle as pixel (left, top), in 1/256 px, sees it.
template <class Int>
PixelTriangleOf<Int> in_pixel(const Int x[3], const Int y[3], Int left, Int top) {
  PixelTriangleOf<Int> triangle;
  for (int k = 0; k < 3; ++k) triangle.x[k] = x[k] - left, triangle.y[k] = y[k] - top;
  return triangle;
}

// All of a depth range's input but depth.
template <class Int, class Float>
void set_geometry(const PixelTriangleOf<Int>& triangle, DepthRangeInput<Float>& in) {
  const Float unit(kUnit), unit_area(kUnit * kUnit);
  for (int k = 0; k < 3; ++k) {
    const EdgeInPixel<Int> edge = edge_in_pixel(triangle, k);
    in.u[k] = to_float(triangle.x[k]) * unit;
    in.v[k] = to_float(triangle.y[k]) * unit;
    const Int right = edge.a * Int(kSubpixelUnits), down = edge.b * Int(kSubpixelUnits);
    const Int corners[4] = {edge.c, edge.c + right, edge.c + down, edge.c + right + down};
    for (int corner = 0; corner < 4; ++corner) in.corner[k][corner] = to_float(corners[corner]) * unit_area;
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
