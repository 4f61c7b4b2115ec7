// The difference of two depth planes over a pixel: at its centre, and how far it may be from that at its corners. It is
// below 0 where the first plane is nearer.
#pragma once

#include "simd/depth_plane.h"
#include "simd/scalar.h"

namespace beampipe {

namespace scalar {
#include "simd/plane_gap-inl.h"
}
using namespace scalar;

}  // namespace beampipe
