// What alpha_mask is charged.
#pragma once

#include "stages/cost/counting.h"
#include "stages/data/mix_bits.h"

namespace beampipe {

// How often each part ran.
struct AlphaMaskWork {
  std::uint64_t fragments = 0;     // that are not opaque
  std::uint64_t covers = 0;        // fragments of cutouts that were looked up as a whole
  std::uint64_t tests = 0;         // of positions or parts of a pixel, and of specks as a whole
  std::uint64_t mixed = 0;         // of these, where texels are small: they pass in part
  std::uint64_t ranked = 0;        // positions that were chosen by their ranks
  std::uint64_t interpolated = 0;  // positions whose alpha lies between four texels
  std::uint64_t masks = 0;         // of fragments that have positions
  std::uint64_t shares = 0;        // of positions that are left of a cutout
  std::uint64_t dropped = 0;
  OperationCounts alphas{};  // what finding alpha costs: at each position that is tested, or once in a footprint
};

// The rank of a position is read from the table of its sheet's order, flipped, moved and compared.
inline OperationCounts rank_cost() { return {.add = 2, .bit = 1, .fetch = 1}; }

// The order of the fragment's sheet, how its ranks are flipped and moved in a pixel, and the opacity as a rank.
inline OperationCounts flip_cost() {
  return count_operations([](OperationCounts& counts) {
    Counted<std::uint32_t> random(1, counts);
    for (int i = 0; i < 4; ++i) random = mix_bits(random + Counted<std::uint32_t>(1));
    random = random >> 16;
    static_cast<void>(to_float(random) * Counted<float>(1.0f) * Counted<float>(1.0f));
    ++counts.fetch;
  });
}

// A position that is tested: a comparison with the cutoff, a selection, and a sum.
inline OperationCounts test_cost() { return {.add = 3}; }

// The alpha that the texture must reach: a quotient. It is compared with the first and the last of the four values that
// have shares; its place between them is a difference and a quotient, which is limited and split into a whole number
// and the rest; two shares are interpolated.
inline OperationCounts mixed_cost() { return {.mul_add = 2, .add = 2 + 1 + 2 + 1 + 1, .special = 2, .convert = 2}; }

// Four texels are compared with 0 and 1.
inline OperationCounts cover_cost() { return {.add = 2, .bit = 6}; }

// The place of a position between four texels, alpha there, and its comparison with the cutoff.
inline OperationCounts patch_cost() { return {.mul_add = 4 + 3 + 1, .add = 2}; }

// What is left of an area, and the share of positions that says so.
inline OperationCounts part_cost() { return {.mul_add = 1}; }
inline OperationCounts share_cost() { return {.bit = 1, .special = 1}; }

// `words`: of a mask.
inline void charge(const AlphaMaskWork& work, std::size_t words, StageCounters& counters) {
  counters.items_in += work.fragments;
  counters.items_out += work.fragments - work.dropped;
  counters.ops += work.alphas;
  counters.ops += flip_cost() * work.masks;
  counters.ops += test_cost() * work.tests;
  counters.ops += mixed_cost() * work.mixed;
  counters.ops += rank_cost() * work.ranked;
  counters.ops += cover_cost() * work.covers;
  counters.ops += patch_cost() * work.interpolated;
  counters.ops += part_cost() * work.fragments;
  counters.ops += share_cost() * work.shares;
  constexpr std::uint64_t kSheetBytes = 4;
  counters.bytes_read += work.fragments * (4 * words + 2) + work.masks * kSheetBytes;
  counters.bytes_written += (work.fragments - work.dropped) * (4 * words + 2);
  counters.lanes_used += work.ranked + work.interpolated;
  counters.lanes_issued += work.ranked + work.interpolated;
}

}  // namespace beampipe
