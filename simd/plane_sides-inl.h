// On which side of a depth plane the planes of several surfaces lie, in the whole pixel. Inlined into kernels, once per
// SIMD target. Lanes are across surfaces.
#if defined(BEAMPIPE_SIMD_PLANE_SIDES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef BEAMPIPE_SIMD_PLANE_SIDES_INL_H_
#undef BEAMPIPE_SIMD_PLANE_SIDES_INL_H_
#else
#define BEAMPIPE_SIMD_PLANE_SIDES_INL_H_
#endif

#include <bit>
#include <cstddef>
#include <cstdint>

#include "simd/depth_plane.h"
#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace beampipe {
namespace HWY_NAMESPACE {

// Of kCount surfaces, at most 64.
template <std::size_t kCount>
struct PlaneSides {
  std::uint64_t nearer = 0;    // bit i: the plane is nearer than this surface in the whole pixel
  std::uint64_t crossing = 0;  // bit i: which one is nearer depends on the place in the pixel, or rounding hides it
};

namespace vectors {
#include "simd/depth_plane-inl.h"
//
#include "simd/plane_gap-inl.h"
}  // namespace vectors

// The surfaces' planes are rows of kCount numbers. As many as the next power of two are read.
template <std::size_t kCount>
HWY_INLINE PlaneSides<kCount> plane_sides(const DepthPlane<float>& plane, const DepthPlane<const float*>& surfaces) {
  const hn::CappedTag<float, std::bit_ceil(kCount)> d;
  using Reals = Lanes<decltype(hn::CappedTag<float, std::bit_ceil(kCount)>())>;
  const DepthPlane<Reals> in_every_lane{Reals(plane.z), Reals(plane.dzdu), Reals(plane.dzdv)};
  PlaneSides<kCount> sides;
  for (std::size_t i = 0; i < kCount; i += hn::MaxLanes(d)) {
    const DepthPlane<Reals> others{Reals(hn::LoadU(d, surfaces.z + i)), Reals(hn::LoadU(d, surfaces.dzdu + i)),
                                   Reals(hn::LoadU(d, surfaces.dzdv + i))};
    const auto gap = vectors::plane_gap(in_every_lane, others);
    const auto nearer = vectors::is_nearer(gap), farther = vectors::is_farther(gap);
    sides.nearer |= std::uint64_t{mask_bits(nearer)} << i;
    sides.crossing |= std::uint64_t{mask_bits(!(nearer | farther))} << i;
  }
  return sides;
}

}  // namespace HWY_NAMESPACE
}  // namespace beampipe
HWY_AFTER_NAMESPACE();

#endif
