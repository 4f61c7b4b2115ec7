// What alpha_mask is charged.
#pragma once

#include "stages/cost/counting.h"
#include "stages/data/mix_bits.h"

namespace beampipe {

// How often each part ran.
struct AlphaMaskWork {
  std::uint64_t fragments = 0;  // that are not opaque
  std::uint64_t positions = 0;  // tested by a texture fetch each
  std::uint64_t ranked = 0;     // positions that were chosen by opacity alone
  std::uint64_t masks = 0;      // of fragments that have positions
  std::uint64_t shares = 0;     // of positions that are left of a cutout
  std::uint64_t dropped = 0;
  OperationCounts alphas{};  // what finding alpha costs: at each position that is tested, or once in a footprint
};

// The rank of a position is read from a table of the draw's dimension, flipped, moved and compared.
inline OperationCounts rank_cost() { return {.add = 2, .bit = 1, .fetch = 1}; }

// How ranks are flipped and moved in a pixel, and the opacity as a rank.
inline OperationCounts flip_cost() {
  return count_operations([](OperationCounts& counts) {
    Counted<std::uint32_t> random(1, counts);
    for (int i = 0; i < 3; ++i) random = mix_bits(random + Counted<std::uint32_t>(1));
    random = random >> 16;
    static_cast<void>(to_float(random) * Counted<float>(1.0f) * Counted<float>(1.0f));
  });
}

// A position that is tested: a comparison with the cutoff, a selection, and a sum.
inline OperationCounts test_cost() { return {.add = 3}; }

// What is left of an area, and the share of positions that says so.
inline OperationCounts part_cost() { return {.mul_add = 1}; }
inline OperationCounts share_cost() { return {.bit = 1, .special = 1}; }

// `words`: of a mask.
inline void charge(const AlphaMaskWork& work, std::size_t words, StageCounters& counters) {
  counters.items_in += work.fragments;
  counters.items_out += work.fragments - work.dropped;
  counters.ops += work.alphas;
  counters.ops += flip_cost() * work.masks;
  counters.ops += test_cost() * work.positions;
  counters.ops += rank_cost() * (work.positions + work.ranked);
  counters.ops += part_cost() * work.fragments;
  counters.ops += share_cost() * work.shares;
  counters.bytes_read += work.fragments * (4 * words + 2);
  counters.bytes_written += (work.fragments - work.dropped) * (4 * words + 2);
  counters.lanes_used += work.positions + work.ranked;
  counters.lanes_issued += work.positions + work.ranked;
}

}  // namespace beampipe
