// What compose_z3 is charged.
#pragma once

#include <bit>

#include "stages/beam/compose_z3.h"
#include "stages/cost/plane_cost.h"

namespace beampipe {

struct Z3Work {
  std::uint64_t fragments = 0;
  std::uint64_t taken = 0;            // fragments that took a position
  std::uint64_t planes_compared = 0;  // at all positions
  std::uint64_t merges = 0;
};

// Per layer, to convert two slopes and a colour from the stored formats or into them.
inline OperationCounts layer_format_cost() { return {.convert = 2 + 3}; }

// Per fragment: its slopes are rounded to the stored format like those that they are compared with, and its colour is
// converted from fp16.
inline OperationCounts arrival_cost() { return {.convert = 2 * 2 + 3}; }

// Per word of a fragment's mask, for each layer: to find the layer's positions and the contested ones among them (1
// operation), to take from the fragment the contested positions where it is not nearer (4), and from the layer those
// where it is (3). Nothing branches.
inline OperationCounts z3_contest_cost() {
  OperationCounts counts;
  for (std::uint32_t k = 0; k < kZ3Layers; ++k) counts += find_cost<kZ3Planes>(k + 1);
  counts.bit += kZ3Layers * (1 + 4 + 3);
  return counts;
}

// To merge two of `layers` layers: to find the two that are closest, and to compute their mean.
inline OperationCounts layer_merge_cost(std::size_t layers, std::size_t words) {
  OperationCounts cost = count_cost(words) * 2;
  cost += count_operations([&](OperationCounts& counts) {
    using Number = Counted<float>;
    const Number one(1.0f, counts);
    const std::size_t pairs = layers * (layers - 1) / 2;
    for (std::size_t pair = 0; pair < pairs; ++pair) {
      magnitude(one - one);
      static_cast<void>(one < one);
    }
    const Number share = one / (one + one), rest = one - share;
    for (int value = 0; value < 3 + 3; ++value) share* one + rest* one;  // plane and colour
    counts.bit += words;
  });
  return cost;
}

template <std::size_t Words>
void charge(const Z3Work& work, StageCounters& counters) {
  constexpr std::uint64_t kFragmentBytes = 4 + 4 * Words + 12 + 6;  // pixel, mask, depth plane, colour
  counters.items_in += work.fragments;
  counters.items_out += work.taken;
  counters.ops += arrival_cost() * work.fragments;
  counters.ops += layer_format_cost() * ((work.fragments + work.taken) * kZ3Layers);
  counters.ops += z3_contest_cost() * (Words * work.fragments);
  counters.ops += nearer_cost() * (32 * Words * work.planes_compared);
  counters.ops += layer_merge_cost(kZ3Layers + 1, Words) * work.merges;
  for (std::uint32_t k = 0; k < kZ3Layers; ++k) counters.ops += put_cost<kZ3Planes>(k + 1) * (Words * work.taken);
  counters.position_tests += 32 * Words * work.planes_compared;
  counters.bytes_read += work.fragments * (kFragmentBytes + sizeof(Z3Pixel<Words>));
  counters.bytes_written += work.taken * sizeof(Z3Pixel<Words>);
  counters.lanes_used += work.taken;
  counters.lanes_issued += work.fragments;
}

}  // namespace beampipe
