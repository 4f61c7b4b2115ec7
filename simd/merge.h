// Merging a fragment into the aggregate of its pixel: the published rules (Crassin et al. 2018, section 2.2).
#pragma once

#include <cstddef>
#include <cstdint>

#include "simd/depth_plane.h"
#include "simd/merge_rules.h"
#include "simd/sample_pattern.h"
#include "simd/scalar.h"

namespace beampipe {

// Fragments and aggregates have the same members (section 2.1): coverage, mask, depth slab, depth range and colour. An
// empty aggregate has alpha 0, mask 0 and z_min > z_max. Depths run from -1 near to 0 far.
template <class Float, class Mask>
struct AggregateOf {
  Float alpha;  // covered area of the pixel, 0..1
  Mask mask;    // localization: where the coverage is, but not how much
  DepthPlane<Float> plane;
  Float thickness;     // of the slab around the plane, in depth; 0 for a single triangle
  Float z_min, z_max;  // depth range within the pixel
  Float color[3];      // linear RGB times alpha
};
using Aggregate = AggregateOf<float, std::uint32_t>;

inline constexpr Aggregate kEmptyAggregate = {0.0f, 0u, {0.0f, 0.0f, 0.0f}, 0.0f, 1.0f, -2.0f, {0.0f, 0.0f, 0.0f}};

// What is merged: an aggregate of one triangle. A speck covers no mask position and was given the nearest ones.
template <class Float, class Mask>
struct FragmentOf {
  AggregateOf<Float, Mask> surface;
  Mask tiny;  // ~0 for a speck, else 0
};
using MergeFragment = FragmentOf<float, std::uint32_t>;

// aggregates[i] = fragments[i] merged into aggregates[i]. Mask bit s belongs to position s of the pattern, which
// has 32. Lanes are across pixels. The same bits as the formula on float, on every target.
void merge(const MergeFragment* fragments, std::size_t count, const SamplePattern& pattern, const MergeRules& rules,
           Aggregate* aggregates);

namespace scalar {
#include "simd/merge-inl.h"
}
using namespace scalar;

}  // namespace beampipe
