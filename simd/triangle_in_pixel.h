// A triangle as one pixel sees it: what the per-pixel kernels read.
#pragma once

#include <cstdint>

#include "simd/sample_pattern.h"

namespace beampipe {

// Vertices in 1/256 px from the pixel's upper left corner, x to the right, y down, |x|, |y| <= 2^24; ordered so that
// the inside is at E >= 0 for every edge. Edge k runs from vertex k to vertex (k + 1) % 3.
template <class Int>
struct TriangleInPixelOf {
  Int x[3], y[3];
};
using TriangleInPixel = TriangleInPixelOf<std::int32_t>;

// E(x, y) = a x + b y + c. All values are integers below 2^50, so 64-bit integers and doubles hold them exactly.
template <class Int>
struct EdgeInPixel {
  Int a, b, c;
};

namespace scalar {
#include "simd/triangle_in_pixel-inl.h"
}
using namespace scalar;

// The top-left rule: does a triangle own the samples that lie exactly on this edge? It does if the edge is a left edge
// or a horizontal top edge.
template <class Int>
bool owns_its_samples(Int a, Int b) {
  return (a > Int(0)) | ((a == Int(0)) & (b > Int(0)));
}

}  // namespace beampipe
