// What the compositions by the published rules share: the form of a fragment, and numbers for counting.
#pragma once

#include "simd/merge.h"
#include "stages/cost/counting.h"
#include "stages/data/casav_aggregate.h"
#include "stages/data/fragment.h"
#include "stages/data/pixel_observer.h"

namespace beampipe {

// The fragment in the form that the published rules take, with 32 mask positions.
inline MergeFragment merge_fragment(const Fragment& fragment) {
  const glm::vec3& color = fragment.color;
  return {{.alpha = fragment.alpha,
           .mask = fragment.mask.words[0],
           .plane = fragment.plane,
           .thickness = 0.0f,
           .z_min = fragment.z_min,
           .z_max = fragment.z_max,
           .color = {color.r, color.g, color.b}},
          fragment.tiny ? ~0u : 0u,
          0u};
}

// Tells that the aggregate at `place` and what lies behind it become `together`. A merge by the rules is linear in
// colours, so merging two colours of 1 gives the factors.
inline void tell_merge(std::size_t place, const Aggregate& nearer, const MergeFragment& farther,
                       const Aggregate& together, const CasavMerging& merging, PixelObserver& observer) {
  Aggregate unit = nearer;
  MergeFragment other = farther;
  for (int c = 0; c < 3; ++c) unit.color[c] = c == 0, other.surface.color[c] = c == 1;
  const Aggregate factors = merge_formula(other, unit, merging.positions, merging.rules);
  observer.joins(place, {nearer, farther.surface, together, factors.color[0], factors.color[1]});
}

// The distance between the depth ranges of two aggregates, of which the first one is nearer; below 0 if they overlap.
template <class Float, class Mask>
Float depth_between(const AggregateOf<Float, Mask>& nearer, const AggregateOf<Float, Mask>& farther) {
  return farther.z_min - nearer.z_max;
}

inline FragmentOf<Counted<float>, Counted<std::uint32_t>> counted_fragment(OperationCounts& counts) {
  const Counted<float> one(1.0f, counts);
  const Counted<std::uint32_t> all(~0u, counts);
  return {{.alpha = one,
           .mask = all,
           .plane = {one, one, one},
           .thickness = one,
           .z_min = one,
           .z_max = one,
           .color = {one, one, one}},
          all,
          all};
}

// How many numbers of a stored aggregate must be converted to float32.
constexpr std::uint64_t packed_numbers(CasavStorage storage) {
  constexpr std::uint64_t kColor = 3, kSlopesAndThickness = 3;
  return storage == CasavStorage::slides ? kColor : kColor + kSlopesAndThickness;
}

}  // namespace beampipe
