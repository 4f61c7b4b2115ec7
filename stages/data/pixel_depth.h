// The depth of a triangle in one pixel or cell: its plane, and bounds on it. For numbers and for numbers that count
// (stages/cost/counting.h).
#pragma once

#include <cstdint>

#include "simd/depth_bounds.h"
#include "simd/depth_range.h"
#include "simd/merge.h"
#include "simd/sample_pattern.h"
#include "simd/scalar.h"
#include "stages/data/setup_triangle.h"

namespace beampipe {

// The triangle's depth plane in the pixel (x, y) of the frame: the depth at the pixel's centre and slopes per pixel.
inline DepthPlane<float> pixel_plane(const SetupTriangle& triangle, std::int32_t x, std::int32_t y) {
  return {static_cast<float>(triangle.depth.at(x + 0.5, y + 0.5)), static_cast<float>(triangle.depth.dzdx),
          static_cast<float>(triangle.depth.dzdy)};
}

// The triangle's depth at the upper left corner of a cell, which is (x, y), in pixels.
template <class Real>
auto cell_depth(const ScreenDepthOf<Real>& depth, Real x, Real y) {
  return to_float(depth.at(x, y));
}

// The triangle's depth plane for the samples of that cell.
template <class Real>
auto cell_plane(const ScreenDepthOf<Real>& depth, Real x, Real y) {
  const Real unit(1.0 / kSubpixelUnits);
  using Float = decltype(to_float(unit));
  return CellPlane<Float>{cell_depth(depth, x, y), to_float(depth.dzdx * unit), to_float(depth.dzdy * unit)};
}

// Bounds of a triangle anywhere: the depths of its vertices.
template <class Float>
DepthBounds<Float> vertex_bounds(const Float z[3]) {
  return {lesser(lesser(z[0], z[1]), z[2]), greater(greater(z[0], z[1]), z[2])};
}

inline double to_double(float x) { return x; }

// Bounds of the depths that the depth test computes for the triangle's samples. The test works in single precision from
// a corner of the cell, at most one pixel away, so its results may lie beyond the vertices by a rounding error. The
// margin is eight roundings of the largest sum that can occur.
template <class Float, class Real>
DepthBounds<Float> sample_bounds(const DepthBounds<Float>& vertices, Real dzdx, Real dzdy) {
  const Real rounding(0x1p-21);
  const Real largest = greater(magnitude(to_double(vertices.nearest)), magnitude(to_double(vertices.farthest)));
  const Float margin = to_float(rounding * (magnitude(dzdx) + magnitude(dzdy) + largest));
  return {vertices.nearest - margin, vertices.farthest + margin};
}

}  // namespace beampipe
