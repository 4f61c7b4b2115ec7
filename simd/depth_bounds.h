// Bounds of a triangle's depth in a pixel.
#pragma once

#include "simd/depth_plane.h"
#include "simd/scalar.h"
#include "simd/triangle_setup.h"

namespace beampipe {

template <class Float>
struct DepthBounds {
  Float nearest, farthest;
};

namespace scalar {
#include "simd/depth_bounds-inl.h"
}
using namespace scalar;

}  // namespace beampipe
