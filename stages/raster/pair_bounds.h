// Between which depths a triangle lies within a pixel: its plane over the whole pixel, cut by the depths of its
// vertices. And what that, and asking whether the pair is hidden, is charged with.
#pragma once

#include "simd/depth_range.h"
#include "stages/cost/plane_cost.h"

namespace beampipe {

// The nearest and the farthest depth.
template <class Float>
struct DepthBounds {
  Float nearest, farthest;
};

template <class Float>
DepthBounds<Float> vertex_bounds(const Float z[3]) {
  return {lesser(lesser(z[0], z[1]), z[2]), greater(greater(z[0], z[1]), z[2])};
}

template <class Float>
DepthBounds<Float> pair_bounds(const DepthPlane<Float>& plane, const DepthBounds<Float>& vertices) {
  const Float reach = Float(0.5f) * (magnitude(plane.dzdu) + magnitude(plane.dzdv));
  return {lesser(greater(plane.z - reach, vertices.nearest), vertices.farthest),
          greater(lesser(plane.z + reach, vertices.farthest), vertices.nearest)};
}

inline double to_double(float x) { return x; }

// As far beyond the vertices as rounding may take a depth that is computed in single precision from a corner of a pixel
// or of a part of one: eight times a single rounding of what is added up.
template <class Float, class Real>
DepthBounds<Float> sample_bounds(const DepthBounds<Float>& vertices, Real dzdx, Real dzdy) {
  const Real rounding(0x1p-21);
  const Real largest = greater(magnitude(to_double(vertices.nearest)), magnitude(to_double(vertices.farthest)));
  const Float margin = to_float(rounding * (magnitude(dzdx) + magnitude(dzdy) + largest));
  return {vertices.nearest - margin, vertices.farthest + margin};
}

inline OperationCounts sample_bounds_cost() {
  return count_operations([](OperationCounts& counts) {
    const Counted<float> z[3] = {Counted<float>(0, counts), Counted<float>(0, counts), Counted<float>(0, counts)};
    const Counted<double> slope(0.0, counts);
    sample_bounds(vertex_bounds(z), slope, slope);
  });
}

inline OperationCounts vertex_bounds_cost() {
  return count_operations([](OperationCounts& counts) {
    const Counted<float> z[3] = {Counted<float>(0, counts), Counted<float>(0, counts), Counted<float>(0, counts)};
    vertex_bounds(z);
  });
}

// The plane over the pixel included.
inline OperationCounts pair_bounds_cost() {
  OperationCounts cost = plane_cost();
  cost += count_operations([](OperationCounts& counts) {
    const Counted<float> z(0.0f, counts);
    pair_bounds<Counted<float>>({z, z, z}, {z, z});
  });
  return cost;
}

}  // namespace beampipe
