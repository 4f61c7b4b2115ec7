// Merging a fragment into the aggregate of its pixel: the published rules (Crassin et al. 2018, section 2.2).
#pragma once

#include <cstddef>
#include <cstdint>

#include "simd/depth_plane.h"
#include "simd/mask_table.h"
#include "simd/merge_rules.h"
#include "simd/plane_gap.h"
#include "simd/plane_order.h"
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

inline constexpr Aggregate kEmptyAggregate = {.alpha = 0.0f,
                                              .mask = 0u,
                                              .plane = {0.0f, 0.0f, 0.0f},
                                              .thickness = 0.0f,
                                              .z_min = 1.0f,
                                              .z_max = -2.0f,
                                              .color = {0.0f, 0.0f, 0.0f}};

// What is merged: an aggregate of one triangle. A speck covers no mask position and was given the nearest ones.
template <class Float, class Mask>
struct FragmentOf {
  AggregateOf<Float, Mask> surface;
  Mask tiny;   // ~0 for a speck, else 0
  Mask front;  // with Partition::given: the positions at which it is in front of all that was merged before
};
using MergeFragment = FragmentOf<float, std::uint32_t>;

// Where the bits of a mask lie in a pixel. The pattern has 32 positions.
struct MergePositions {
  SamplePattern pattern;
  MaskTable table;

  explicit MergePositions(const SamplePattern& of) : pattern(of), table(of) {}
};

// Which parts of a merge had work. Masks have a bit for each position that was looked at; the others are 0 or 1.
template <class Mask>
struct MergeStepsOf {
  Mask merged;                 // the pixel was not empty
  Mask overlap;                // mask: of both
  Mask lines;                  // planes were compared (Partition::lines) ...
  Mask front_line, back_line;  // ... and these lines cut the pixel
  Mask tested;                 // mask: depths were compared there (Partition::positions)
  Mask fuzzy;                  // mask: within the slab
  Mask reached;                // mask: where the slab's thickness was measured ...
  Mask moved;                  // ... and, mask, how far its plane moved (Thickness::containing)
};
using MergeSteps = MergeStepsOf<std::uint32_t>;

// aggregates[i] = fragments[i] merged into aggregates[i], and steps[i] is how. Lanes are across pixels. The same bits
// as the formula on float, on every target.
void merge(const MergeFragment* fragments, std::size_t count, const MergePositions& positions, const MergeRules& rules,
           Aggregate* aggregates, MergeSteps* steps);

namespace scalar {
#include "simd/merge-inl.h"
}
using namespace scalar;

inline Aggregate merge_formula(const MergeFragment& fragment, const Aggregate& old, const MergePositions& positions,
                               const MergeRules& rules) {
  MergeSteps steps;
  return merge_formula(fragment, old, positions, rules, steps);
}

}  // namespace beampipe
