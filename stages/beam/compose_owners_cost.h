// What compose_owners and finish_owners are charged.
#pragma once

#include <bit>

#include "simd/conserve.h"
#include "stages/beam/owner_rules_cost.h"
#include "stages/data/open_pixel.h"

namespace beampipe {

// How often each operation was done.
struct OwnersWork {
  std::uint64_t fragments = 0;
  std::uint64_t masks = 0;             // fragments that cover a position
  std::uint64_t claims = 0;            // fragments that take a position
  std::uint64_t puts = 0;              // masks of positions put into a state
  std::uint64_t planes = 0;            // of owners, computed again
  std::uint64_t contests = 0;          // owners of positions that a fragment covers
  std::uint64_t planes_compared = 0;   // at all positions
  std::uint64_t listed = 0;            // owners whose positions were counted
  std::uint64_t finality_tests = 0;    // of owners, against the watermark
  std::uint64_t farthest_found = 0;    // farthest depths over an owner's positions
  std::uint64_t measured = 0;          // owners whose mean position was found
  std::uint64_t pairs_compared = 0;    // of owners
  std::uint64_t merges = 0;            // of two owners
  std::uint64_t order_tests = 0;       // to sort owners that become final
  std::uint64_t settlings = 0;         // of one owner or of several at once
  std::uint64_t settled = 0;           // owners that became final
  std::uint64_t bounds_found = 0;      // depth bounds of the owners of pixels without empty positions
  std::uint64_t vertices_bounded = 0;  // owners whose vertices limit these bounds
  std::uint64_t specks = 0, speck_comparisons = 0, specks_added = 0;
  std::uint64_t finished = 0;  // pixels that were read at the end
  std::uint64_t limited = 0;   // of these, pixels whose estimates were compared
};

// To add to a sum in fixed point.
inline void add_fixed(const Counted<float>& x) {
  to_integer(x * Counted<float>(FixedSum::kUnits) + Counted<float>(1.0f)) + Counted<std::int32_t>(0);
}

// To add to a pixel's sums of colours: the exponent, whether the six sums have room, and the additions.
inline void add_colors(const Counted<float>& x, OperationCounts& counts) {
  constexpr std::size_t kCount = ColorSums::kCount;
  counts.bit += 3 * kCount + 3 * kCount;  // bits of the exponent and of the sums are taken apart and put together
  for (std::size_t i = 0; i < kCount; ++i) {
    const Counted<float> units = x * Counted<float>(1.0f);
    static_cast<void>(to_float(Counted<std::int32_t>(0, counts)) + units < x);
    to_integer(units + Counted<float>(1.0f)) + Counted<std::int32_t>(0);
  }
}

// The threshold of a triangle's sums, less than 1.
inline void find_threshold(OperationCounts& counts) {
  Counted<float>(1.0f) - rounding_threshold(Counted<std::uint32_t>(0, counts));
}

// Per word of a fragment's mask: to find the positions that are empty and those of each slot, and to intersect them
// with the mask.
template <std::size_t Words, std::size_t Slots>
OperationCounts owned_cost() {
  using Pixel = OpenPixel<Words, Slots>;
  OperationCounts counts = find_cost<Pixel::kBits>(Pixel::kEmpty);
  for (std::size_t k = 0; k < Slots; ++k) counts += find_cost<Pixel::kBits>(Pixel::owned_by(k));
  counts.bit += 1 + 2 * Slots;  // and to test whether all are lost
  return counts;
}

// Per owner: the mean of its positions, from the sums of their coordinates.
inline OperationCounts mean_cost() {
  return count_operations([](OperationCounts& counts) {
    const Counted<float> one(1.0f, counts), per_unit = one / (one * one);
    for (int axis = 0; axis < 2; ++axis) to_float(Counted<std::int32_t>(0, counts)) * per_unit - Counted<float>(0.5f);
  });
}

// The error and the weight of two owners, their mean colour, and the formats of the slot.
inline OperationCounts merge_cost() {
  return count_operations([](OperationCounts& counts) {
    const Counted<float> one(1.0f, counts);
    for (int owner = 0; owner < 2; ++owner) {
      const Counted<float> fraction = one / one;
      greater(one + fraction * fraction * one, one);
    }
    const Counted<float> scale = one / (one + one);
    for (int c = 0; c < 3; ++c) to_integer((one * one + one * one) * scale * one + one);
    to_integer(one * (one + one));                 // the error
    counts.bit += 3 + 4;                           // to pack both words
    lesser(greater(one, one), greater(one, one));  // the largest channel, for the exponent
    counts.convert += 2;                           // the exponents of two colours
  });
}

// Per owner that becomes final: its part of the positions, its area, and the sums of both estimates.
inline OperationCounts settle_owner_cost() {
  return count_operations([](OperationCounts& counts) {
    using Number = Counted<float>;
    const Number one(1.0f, counts), per_position(1.0f);
    one / one;
    find_threshold(counts);
    const Number exact = greater(one + one, Number(0.0f)) * per_position;
    const Number area =
        visible_area(exact, one, one, one, Taken<Number>{to_float(Counted<std::int32_t>(0, counts)) * one, one});
    one + one;
    add_fixed(area);
    const Number share = one * per_position;
    for (int c = 0; c < 3; ++c) area *one, share *one;
    add_colors(one, counts);
  });
}

// Per speck that is added: its area and colour.
inline OperationCounts speck_area_cost() {
  return count_operations([](OperationCounts& counts) {
    using Number = Counted<float>;
    const Number one(1.0f, counts);
    const Number sums = to_float(Counted<std::int32_t>(0, counts)) + to_float(Counted<std::int32_t>(0, counts));
    find_threshold(counts);
    add_fixed(one * one / Number(3.0f));
    const Number area = lesser(greater(sums, sums) - greater(sums, sums), one - one);
    add_fixed(area);
    for (int c = 0; c < 3; ++c) one* area;
    add_colors(one, counts);
  });
}

template <std::size_t Words, std::size_t Slots>
void charge(const OwnersWork& work, StageCounters& counters) {
  using Pixel = OpenPixel<Words, Slots>;
  constexpr std::uint64_t kPositions = 32 * Words;
  static const UnitCost of_mask = owned_cost<Words, Slots>() * Words, of_put = put_cost<Pixel::kBits>(0) * Words,
                        of_find = find_cost<Pixel::kBits>(Pixel::kFinal) * Words, of_plane = plane_cost(),
                        of_gap = plane_gap_cost(), of_nearer = nearer_cost() * kPositions, of_count = count_cost(Words),
                        of_finality = finality_cost(), of_farthest = farthest_cost() * kPositions,
                        of_mean = mean_cost(), of_pair = pair_cost(), of_merge = merge_cost(),
                        of_settled = settle_owner_cost(), of_bounds = plane_bounds_cost(),
                        of_vertices = vertex_bounds_cost(), of_speck = speck_votes_cost(Pixel::kBits),
                        of_speck_test = speck_test_cost(), of_speck_area = speck_area_cost(), of_limit = limit_cost();
  constexpr OperationCounts kOfOnlyOwner{.add = Slots},                        // does one owner have the whole pixel?
      kOfHiddenTest{.add = 1}, kOfOrderTest{.add = 1}, kOfPosition{.add = 2},  // a position's x and y
      kOfFarther{.add = 1};                                                    // than the owners before it
  counters.items_in += work.fragments;
  counters.items_out += work.claims;
  counters.ops += kOfHiddenTest * work.fragments;
  counters.ops += of_mask * work.masks;
  counters.ops += of_put * work.puts;
  counters.ops += of_plane * work.planes;
  counters.ops += of_gap * work.contests;
  counters.ops += of_nearer * work.planes_compared;
  counters.ops += of_find * (work.listed + work.settlings + work.limited);  // the owner's positions, or the final ones
  counters.ops += of_count * (work.listed + work.settlings + work.limited);
  counters.ops += of_count * work.claims;  // the positions that the fragment covers
  counters.ops += kOfOnlyOwner * work.finished;
  counters.ops += of_finality * work.finality_tests;
  counters.ops += of_farthest * work.farthest_found;
  counters.ops += kOfPosition * (kPositions * work.measured);
  counters.ops += of_mean * work.measured;
  counters.ops += of_pair * work.pairs_compared;
  counters.ops += of_merge * work.merges;
  counters.ops += kOfOrderTest * work.order_tests;
  counters.ops += of_settled * work.settled;
  counters.ops += of_bounds * work.bounds_found;  // their planes are among work.planes
  counters.ops += kOfFarther * work.bounds_found;
  counters.ops += of_vertices * work.vertices_bounded;
  counters.ops += of_speck * work.specks;
  counters.ops += of_speck_test * work.speck_comparisons;
  counters.ops += of_speck_area * work.specks_added;
  counters.ops += of_limit * work.limited;
  counters.bytes_read +=
      work.fragments * (owners_fragment_bytes(Words) + sizeof(float) + Pixel::kBytes) + work.finished * Pixel::kBytes;
  counters.bytes_read += work.planes * (sizeof(std::uint32_t) + sizeof(ScreenDepth));  // by its number in the list
  counters.bytes_written += (work.claims + work.specks_added) * Pixel::kBytes;
  counters.position_tests += kPositions * (work.planes_compared + work.farthest_found);
  counters.lanes_used += work.claims;
  counters.lanes_issued += work.fragments;
}

}  // namespace beampipe
