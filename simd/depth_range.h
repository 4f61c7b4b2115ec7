// The depth range of a triangle clipped to a pixel: over the vertices of the clipped polygon, which are the triangle's
// vertices inside the pixel, the pixel's corners inside the triangle, and the crossings of edges with the pixel's
// border.
//
// Pixel-local coordinates as in simd/coverage.h. Depth is z + dzdu (u - 1/2) + dzdv (v - 1/2).
#pragma once

#include <cstddef>

#include "simd/scalar.h"

namespace beampipe {

// One (pixel, triangle). Vertices are exact. Corner values are edge values at the pixel's corners, exact integers
// rounded to float, in the order (0,0), (1,0), (0,1), (1,1).
template <class Float>
struct DepthRangeInput {
  Float u[3], v[3];  // vertices, pixels
  Float corner[3][4];
  Float z, dzdu, dzdv;  // depth plane: at the pixel's centre, and its change per pixel
  Float vertex_z[3];
};

template <class Float>
struct DepthRange {
  Float z_min, z_max;
};

// out[i] = depth range of in[i]; lanes are across i. Bit-identical to depth_range_scalar on every target.
void depth_range(const DepthRangeInput<float>* in, std::size_t count, DepthRange<float>* out);

// Scalar twin: one lane, also for counting numbers.
template <class Float>
DepthRange<Float> depth_range_scalar(const DepthRangeInput<Float>& in) {
  const Float zero(0.0f), one(1.0f), half(0.5f);
  DepthRange<Float> out;
  const Float z_nearest = lesser(lesser(in.vertex_z[0], in.vertex_z[1]), in.vertex_z[2]);
  const Float z_farthest = greater(greater(in.vertex_z[0], in.vertex_z[1]), in.vertex_z[2]);
  const auto plane = [&](Float u, Float v) {
    const Float z = in.z + in.dzdu * (u - half) + in.dzdv * (v - half);
    return lesser(greater(z, z_nearest), z_farthest);
  };
  out.z_min = z_farthest, out.z_max = z_nearest;
  const auto include = [&](bool valid, Float z) {
    out.z_min = select(valid, lesser(out.z_min, z), out.z_min);
    out.z_max = select(valid, greater(out.z_max, z), out.z_max);
  };
  for (int k = 0; k < 3; ++k) {
    const bool inside_u = (in.u[k] >= zero) & (in.u[k] <= one), inside_v = (in.v[k] >= zero) & (in.v[k] <= one);
    include(inside_u & inside_v, in.vertex_z[k]);
  }
  const Float corner_u[4] = {zero, one, zero, one}, corner_v[4] = {zero, zero, one, one};
  for (int i = 0; i < 4; ++i) {
    const bool inside = (in.corner[0][i] >= zero) & (in.corner[1][i] >= zero) & (in.corner[2][i] >= zero);
    include(inside, plane(corner_u[i], corner_v[i]));
  }
  for (int k = 0; k < 3; ++k) {
    const int next = (k + 1) % 3;
    const Float* corner = in.corner[k];
    const auto crossing = [&](int from, int to) {  // parameter 0..1 along the border between two corners
      const Float difference = corner[from] - corner[to];
      return corner[from] / select(difference == zero, one, difference);
    };
    for (int side = 0; side < 2; ++side) {  // u = 0 and u = 1, then v = 0 and v = 1
      const Float border = side == 0 ? zero : one;
      const bool straddles_u = (in.u[k] < border) != (in.u[next] < border);
      const bool along_v = (corner[side] < zero) != (corner[side + 2] < zero);
      include(straddles_u & along_v, plane(border, crossing(side, side + 2)));
      const bool straddles_v = (in.v[k] < border) != (in.v[next] < border);
      const bool along_u = (corner[2 * side] < zero) != (corner[2 * side + 1] < zero);
      include(straddles_v & along_u, plane(crossing(2 * side, 2 * side + 1), border));
    }
  }
  return out;
}

}  // namespace beampipe
