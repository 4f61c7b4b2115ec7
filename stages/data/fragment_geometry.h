// A triangle's vertices and edges relative to one pixel or cell: the arithmetic that prepares the kernels' input.
//
// The formulas work on numbers and on numbers that count (stages/cost/counting.h): Int is std::int64_t, Float is float
// and Real is double, or each of them is a counting number.
#pragma once

#include <cstdint>

#include "simd/depth_range.h"
#include "simd/sample_pattern.h"
#include "simd/scalar.h"
#include "simd/triangle_in_pixel.h"

namespace beampipe {

inline constexpr float kUnit = 1.0f / kSubpixelUnits;  // 1/256 px, in pixels

// An edge's value at (x, y), both in 1/256 px: a x + b y + c.
template <class Int>
struct EdgeAt {
  Int a, b, c;
  Int at(Int x, Int y) const { return a * x + b * y + c; }
};

// The triangle relative to the pixel whose upper left corner is (left, top). All coordinates are in 1/256 px.
template <class Int>
TriangleInPixelOf<Int> in_pixel(const Int x[3], const Int y[3], Int left, Int top) {
  TriangleInPixelOf<Int> triangle;
  for (int k = 0; k < 3; ++k) triangle.x[k] = x[k] - left, triangle.y[k] = y[k] - top;
  return triangle;
}

// Sets everything in the input of a depth range except the depths.
template <class Int, class Float>
void set_geometry(const TriangleInPixelOf<Int>& triangle, DepthRangeInput<Float>& in) {
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

// An edge's value at the upper left corner of a pixel or cell, such that ">= 0" means inside by the top-left rule.
// `not_owned` is 0 if the triangle owns the samples on this edge, else 1.
template <class Int>
Int owned_edge(const EdgeAt<Int>& edge, Int left, Int top, Int not_owned) {
  return edge.at(left, top) - not_owned;
}

// The signed distance of (x, y) from an edge, in pixels. `per_unit` is 1 px divided by the length of the edge's normal.
template <class Int, class Real>
auto edge_distance(const EdgeAt<Int>& edge, Int x, Int y, Real per_unit) {
  return to_float(to_double(edge.at(x, y)) * per_unit);
}

}  // namespace beampipe
