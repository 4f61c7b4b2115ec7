// Bounds of a triangle's depth in pixels.
#pragma once

#include <cstddef>
#include <cstdint>

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

inline constexpr std::size_t kBoundsBlock = 128;  // pixels

// Columns of pixels of one triangle, with bounds of its depth in each.
struct PixelBounds {
  alignas(64) std::int32_t x[kBoundsBlock], y[kBoundsBlock];  // frame coordinates
  alignas(64) float nearest[kBoundsBlock], farthest[kBoundsBlock];
};

// Sets the bounds of pixels 0 .. count - 1 of a block; those of later pixels are unspecified. `vertices`: bounds of the
// triangle anywhere. Lanes are across pixels. The same bits as pair_bounds of the plane at each pixel's centre, rounded
// to float, on every target.
void find_pair_bounds(const AnchoredPlane<double>& plane, const DepthBounds<float>& vertices, std::size_t count,
                      PixelBounds& pixels);

}  // namespace beampipe
