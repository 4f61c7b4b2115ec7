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

// The same from the upper left corner of a pixel, or of a cell of it, in the units of samples and positions: depth is
// z + dzdx x + dzdy y, x and y in 1/256 px.
template <class Float>
struct CellPlane {
  Float z, dzdx, dzdy;
};

namespace scalar {
#include "simd/depth_plane-inl.h"
}
using namespace scalar;

}  // namespace beampipe
