// Analytic coverage of a pixel by a triangle: area and centroid of the triangle clipped to the pixel.
//
// Pixel-local coordinates, in pixels: u to the right, v down, the pixel is [0,1] x [0,1]. Edge k is E_k(u,v) = a_k u +
// b_k v + c_k, positive inside.
#pragma once

#include <cstddef>

#include "simd/scalar.h"
#include "simd/triangle_in_pixel.h"

namespace beampipe {

template <class Float>
struct Coverage {
  Float alpha;                   // area, 0..1; absolute error below 5e-7
  Float centroid_u, centroid_v;  // of the clipped triangle, inside the pixel
};

// out[i] = coverage of in[i]. Lanes are across i. The same bits as the formula on float, on every target.
void coverage(const TriangleInPixel* in, std::size_t count, Coverage<float>* out);

namespace scalar {
#include "simd/coverage-inl.h"
}
using namespace scalar;

}  // namespace beampipe
