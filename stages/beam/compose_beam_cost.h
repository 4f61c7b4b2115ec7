// What compose_window and compose_whole are charged.
#pragma once

#include <type_traits>

#include "simd/conserve.h"
#include "stages/beam/specks_cost.h"
#include "stages/cost/plane_cost.h"
#include "stages/data/beam_aggregate.h"
#include "stages/data/pair.h"
#include "stages/data/position_set.h"

namespace beampipe {

// How often each operation was done.
struct ComposeWork {
  std::uint64_t fragments = 0, windows = 0;
  std::uint64_t contestants = 0;  // fragments of windows in which several fragments cover the same position
  std::uint64_t depth_tests = 0;  // comparisons at such positions
  std::uint64_t partial = 0;      // fragments that are partly hidden, which are sorted
  std::uint64_t order_tests = 0;  // to sort them
  std::uint64_t visible = 0;      // fragments with positions that were added
  std::uint64_t specks = 0;
  std::uint64_t surface_tests = 0;  // of specks
  std::uint64_t closed = 0;         // pixels that were closed
};

using CountedFloat = Counted<float>;
using CountedBits = Counted<std::uint32_t>;

// Per fragment, word by word: the positions of its mask that are still open and those that other fragments cover too;
// the numbers of positions that it covers and owns.
inline OperationCounts mask_cost(std::size_t words) {
  OperationCounts cost = count_cost(words) * 2;
  cost += count_operations([&](OperationCounts& counts) {
    const CountedBits mask(~0u, counts);
    for (std::size_t i = 0; i < words; ++i) {
      const CountedBits open = mask & ~mask;
      mask | (mask & open);  // covered by several fragments
      mask | open;           // covered by any fragment
      mask | open;           // taken
    }
    const CountedFloat visible(0.0f, counts);
    static_cast<void>(visible == visible);  // is all of it visible?
  });
  return cost;
}

// Per fragment of a window in which several fragments cover the same position: its depth at the pixel's corner, its
// slopes per 1/256 px, and its mask without the positions that it has lost.
inline OperationCounts contest_cost(std::size_t words) {
  return count_operations([&](OperationCounts& counts) {
    const CountedFloat one(1.0f, counts);
    one - CountedFloat(0.5f) * one - CountedFloat(0.5f) * one;
    for (int axis = 0; axis < 2; ++axis) one / CountedFloat(kSubpixelUnits);
    const CountedBits mask(~0u, counts);
    for (std::size_t i = 0; i < words; ++i) mask&(~mask | mask);
  });
}

// To add a fragment's visible area and the same share of its colour.
inline void add_color(const CountedFloat& area, const CountedFloat& one) {
  const CountedFloat share = area / one;
  one + area;
  for (int channel = 0; channel < 3; ++channel) one + share* one;
}

inline OperationCounts addition_cost() {
  return count_operations([](OperationCounts& counts) {
    const CountedFloat one(1.0f, counts);
    const CountedFloat area = visible_area(one, one, one, one, Taken<CountedFloat>{one, one});
    one + one;  // positions
    add_color(area, one);
  });
}

// Per speck: to find the three nearest positions and their owners, to sum up the areas of both sides there, and to add
// the speck's area and colour.
inline OperationCounts speck_cost() {
  return count_operations([](OperationCounts& counts) {
    const CountedFloat one(1.0f, counts), limit(kSpeckShares);
    for (int axis = 0; axis < 2; ++axis) PositionSet::place_of(one);
    CountedFloat votes(0.0f);
    for (int vote = 0; vote < 3; ++vote) votes = votes + one;
    counts.fetch += 1 + 3;                  // the positions and their owners
    counts.bit += 3;                        // the test whether they are taken
    one + one* votes / CountedFloat(3.0f);  // the area of the side that it faces
    const CountedFloat larger = greater(one, one);
    const bool is_front = one >= one;
    static_cast<void>(is_front);
    const CountedFloat area = one * lesser(limit / (one * larger), one);
    add_color(lesser(area, CountedFloat(1.0f) - one), one);
  });
}

// To scale a closed pixel's colour.
inline OperationCounts closing_cost() {
  return count_operations([](OperationCounts& counts) {
    const CountedFloat one(1.0f, counts), scale = one / one;
    for (int channel = 0; channel < 3; ++channel) one* scale;
  });
}

// fp16 colours are converted when an aggregate is loaded and when it is stored.
inline constexpr OperationCounts kFormatCost{.convert = 2 * 3};

template <std::size_t Words>
void charge(const ComposeWork& work, StageCounters& counters) {
  static const UnitCost of_mask = mask_cost(Words), of_contestant = contest_cost(Words),
                        of_depth_test = depth_test_cost(), of_addition = addition_cost(), of_speck = speck_cost(),
                        of_surface_test = speck_test_cost(), of_closing = closing_cost();
  constexpr OperationCounts of_visible_part{.special = 1}, of_order_test{.add = 1}, of_closed_test{.add = 1};
  counters.items_in += work.fragments;
  counters.items_out += work.windows;
  counters.ops += of_mask * work.fragments;
  counters.ops += of_contestant * work.contestants;
  counters.ops += of_depth_test * work.depth_tests;
  counters.ops += of_visible_part * work.partial;
  counters.ops += of_order_test * work.order_tests;
  counters.ops += of_addition * work.visible;
  counters.ops += of_speck * work.specks;
  counters.ops += of_surface_test * work.surface_tests;
  counters.ops += of_closed_test * work.windows;
  counters.ops += of_closing * work.closed;
  counters.ops += kFormatCost * work.windows;
  counters.bytes_read += work.fragments * conserving_fragment_bytes(32 * Words);
  counters.bytes_read += work.windows * sizeof(StoredAggregate<Words>);
  counters.bytes_written += work.windows * sizeof(StoredAggregate<Words>);
  counters.position_tests += work.depth_tests;
  counters.lanes_used += work.depth_tests;
  counters.lanes_issued += work.fragments * 32 * Words;
}

// Pixels that one triangle covers: the pair is read, and its colour is converted and stored.
template <std::size_t Words>
void charge_whole(std::uint64_t pixels, StageCounters& counters) {
  counters.items_in += pixels;
  counters.items_out += pixels;
  counters.ops.convert += 3 * pixels;
  counters.bytes_read += pixels * kPairWithDepthBytes;
  counters.bytes_written += pixels * sizeof(StoredAggregate<Words>);
}

}  // namespace beampipe
