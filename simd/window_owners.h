// Which fragment of a pixel owns which mask positions, where a window of fragments is compared position by position.
#pragma once

#include <cstddef>
#include <cstdint>

#include "simd/depth_plane.h"
#include "simd/sample_pattern.h"
#include "simd/wide_mask.h"

namespace beampipe {

// From the pixel's upper left corner.
inline CellPlane<float> corner_plane(const DepthPlane<float>& plane) {
  return {plane.z - 0.5f * plane.dzdu - 0.5f * plane.dzdv, plane.dzdu / kSubpixelUnits, plane.dzdv / kSubpixelUnits};
}

struct MaskedPlane {
  WideMask mask;           // positions that the fragment covers
  CellPlane<float> plane;  // finite depths
};

struct Ownership {
  WideMask owned;
  std::uint32_t covered, visible;  // how many positions the mask has, and how many of them are owned
};

struct WindowCounts {
  std::uint32_t taken;  // how many positions `taken` has
  std::uint64_t tests;  // depths that were computed
};

// out[i].owned = the positions where in[i] is nearest, without those in `taken`. At equal depth the earlier fragment
// wins. A position that only one fragment covers needs no depth. Bit s of word w belongs to position s of patterns[w].
// Lanes are across positions.
//
// Depths are finite: vertex_setup drops vertices that are not, and the least area of a triangle, 2^-17 px, keeps slopes
// below 2^34 per pixel. A position that several fragments cover, none of them at a finite depth, has no owner.
WindowCounts window_owners(const MaskedPlane* in, std::size_t count, const WideMask& taken,
                           const SamplePattern* patterns, Ownership* out);

// The scalar twin of window_owners. One comparison is depth_test_scalar (simd/depth_compare.h).
WindowCounts window_owners_scalar(const MaskedPlane* in, std::size_t count, const WideMask& taken,
                                  const SamplePattern* patterns, Ownership* out);

}  // namespace beampipe
