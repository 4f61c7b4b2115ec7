// Depth as a plane over a pixel.
#pragma once

#include "simd/scalar.h"

namespace beampipe {

// Depth is z + dzdu (u - 1/2) + dzdv (v - 1/2), u and v in pixels from the pixel's upper left corner; from -1 near to 0
// far.
template <class Float>
struct DepthPlane {
  Float z, dzdu, dzdv;
};

namespace scalar {
#include "simd/depth_plane-inl.h"
}
using namespace scalar;

}  // namespace beampipe
