// Who owns which mask positions, among fragments of one pixel that are compared position by position.
#pragma once

#include <cstddef>
#include <cstdint>

#include "simd/merge.h"
#include "simd/wide_mask.h"

namespace beampipe {

// A depth plane as positions see it: the depth at the pixel's upper left corner, slopes per 1/256 px.
struct CornerPlane {
  float corner, dzdx, dzdy;
};
inline CornerPlane corner_plane(const DepthPlane<float>& plane) {
  return {plane.z - 0.5f * plane.dzdu - 0.5f * plane.dzdv, plane.dzdu / kSubpixelUnits, plane.dzdv / kSubpixelUnits};
}

struct MaskedPlane {
  WideMask mask;      // positions that the fragment covers
  CornerPlane plane;  // finite depths
};

struct Ownership {
  WideMask owned;
  std::uint32_t covered, visible;  // positions of the mask, and of those the owned ones
};

struct WindowCounts {
  std::uint32_t taken;  // positions of `taken`
  std::uint64_t tests;  // depths that were computed
};

// out[i] = the positions where in[i] is nearest, `taken` ones apart. At equal depth the earlier fragment. Positions
// that one fragment alone covers need no depth. Bit s of word w stands at position s of patterns[w]. Lanes are across
// positions. Depths are finite: vertex_setup drops vertices that are not, and a triangle's least area, 2^-17 px, keeps
// slopes below 2^34 per pixel. Where several planes meet and none has a finite depth, nobody owns the position.
WindowCounts window_owners(const MaskedPlane* in, std::size_t count, const WideMask& taken,
                           const SamplePattern* patterns, Ownership* out);

// Scalar twin of one comparison: is the plane nearer at (x, y), in 1/256 px from the pixel's corner? `corner` is its
// depth there, slopes are per 1/256 px.
template <class Float>
bool nearer_at(Float corner, Float dzdx, Float dzdy, Float x, Float y, Float nearest, Float& depth) {
  depth = corner + dzdx * x + dzdy * y;
  return depth < nearest;
}

// Scalar twin of the whole.
WindowCounts window_owners_scalar(const MaskedPlane* in, std::size_t count, const WideMask& taken,
                                  const SamplePattern* patterns, Ownership* out);

}  // namespace beampipe
