// The depth range of a triangle clipped to a pixel. The nearest and the farthest depth lie at vertices of the clipped
// polygon: the triangle's vertices inside the pixel, the pixel's corners inside the triangle, and the points where
// edges cross the pixel's border.
//
// Pixel-local coordinates as in simd/coverage.h. Depth is z + dzdu (u - 1/2) + dzdv (v - 1/2), from -1 near to 0 far.
#pragma once

#include <cstddef>

#include "simd/scalar.h"

namespace beampipe {

// One pair of a pixel and a triangle. Vertices are exact. corner[k] holds the values of edge k
// (simd/triangle_in_pixel.h) at the pixel's corners (0,0), (1,0), (0,1), (1,1): exact integers, rounded to float, times
// 2^-16.
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

// out[i] = depth range of in[i]. Lanes are across i. The same bits as the formula on float, on every target.
void depth_range(const DepthRangeInput<float>* in, std::size_t count, DepthRange<float>* out);

namespace scalar {
#include "simd/depth_range-inl.h"
}
using namespace scalar;

}  // namespace beampipe
