// What compose_regions and finish_regions are charged.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "stages/beam/owner_rules_cost.h"
#include "stages/beam/region_rules.h"
#include "stages/cost/counted_mask.h"
#include "stages/cost/plane_cost.h"
#include "stages/data/region_pixels.h"
#include "stages/rop/rop_cost.h"

namespace beampipe {

// How often each operation was done. What depends on the draw's state is charged at once.
struct RegionsWork {
  std::uint64_t fragments = 0;
  std::uint64_t whole = 0;                              // of these, triangles that cover their pixel
  std::uint64_t changing = 0;                           // of these, fragments that changed the pixel
  std::uint64_t specks = 0;                             // fragments that cover no position
  std::array<std::uint64_t, 6> splits{};                // by bit planes: pixels whose positions were taken apart
  std::array<std::uint64_t, kMostRegions + 1> joins{};  // by regions: pixels whose positions were put together
  std::uint64_t masks_tested = 0;                       // regions whose positions were intersected with a mask
  std::uint64_t counts = 0;                             // of positions of a mask
  std::uint64_t planes = 0;                             // of regions, computed again
  std::uint64_t contests = 0;                           // depth tests of regions
  std::uint64_t positions_compared = 0;                 // of these, at positions
  std::uint64_t parts = 0;                              // regions whose area was divided
  std::uint64_t comparisons = 0;                        // of the states of two regions
  std::uint64_t channels_compared = 0;                  // of two colours
  std::uint64_t pairs_compared = 0;                     // of regions that may be merged
  std::uint64_t mixes = 0;                              // of the colours of two regions
  std::uint64_t finished = 0;                           // regions that were added to their pixel
  OperationCounts by_state{};                           // stencil tests and operations, and blending
  std::uint64_t bytes_read = 0, bytes_written = 0;      // of words and records
};

namespace region_costs {

using Number = Counted<float>;

inline OperationCounts contest() {
  return count_operations([](OperationCounts& counts) {
    const Number one(1.0f, counts);
    depth_passing(Compare::less, DepthPlane<Number>{one, one, one}, DepthPlane<Number>{one, one, one * one});
  });
}
inline OperationCounts contest_at_position() {
  return count_operations([](OperationCounts& counts) {
    const Number one(1.0f, counts);
    const DepthPlane<Number> plane{one, one, one};
    depth_passes_at(Compare::less, plane, plane, one, one);
  });
}

// A region's area, divided: the part inside, its share of the fragment's area, and both in units.
inline OperationCounts part() {
  return count_operations([](OperationCounts& counts) {
    const Number one(1.0f, counts);
    const Number part = part_inside(to_float(Counted<std::int32_t>(1, counts)), one, one);
    const Counted<std::int32_t> units = to_integer(lesser(part * one, one) + Number(0.5f));
    units - units;
  });
}

inline OperationCounts mix() {
  return count_operations([](OperationCounts& counts) {
    const Number one(1.0f, counts);
    const Number share = share_of(one, one);
    for (int c = 0; c < 4; ++c) converted(mixture(converted(one), converted(one), share));
    mixture(one, one, share);  // the part that is drawn
  });
}

inline OperationCounts pair() {
  return count_operations([](OperationCounts& counts) {
    const Number one(1.0f, counts), color[] = {one, one, one, one};
    const DepthPlane<Number> plane{one, one, one};
    for (int end = 0; end < 2; ++end) depth_ratio(depth_at(plane, one, one), depth_at(plane, one, one));
    static_cast<void>(loss_of_merge(color, color, greater(one, one), true, one) < one);
  });
}

// A region's colour times its area.
inline OperationCounts addition() {
  return count_operations([](OperationCounts& counts) {
    const Number one(1.0f, counts);
    for (int c = 0; c < 4; ++c) one + converted(one) * one;
  });
}

}  // namespace region_costs

// The costs that depend on the words of masks alone.
struct RegionUnitCosts {
  explicit RegionUnitCosts(std::size_t words) : count(count_cost(words)), meeting(OperationCounts{}), parting({}) {
    meeting = count_operations([&](OperationCounts& counts) {
      const CountedMask mask{words, &counts};
      (mask & mask).none();
    });
    parting = count_operations([&](OperationCounts& counts) {
      const CountedMask mask{words, &counts};
      without(mask, mask).none();
    });
    for (std::size_t planes = 0; planes < 6; ++planes) splits.emplace_back(split_cost(planes, words));
    for (std::size_t states = 0; states <= kMostRegions; ++states) joins.emplace_back(join_cost(states, words));
  }

  UnitCost count, meeting, parting;
  std::vector<UnitCost> splits, joins;
};

void charge(const RegionsWork& work, std::size_t words, StageCounters& counters);

}  // namespace beampipe
