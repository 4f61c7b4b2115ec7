// What compose_pooled and finish_pooled are charged.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "simd/conserve.h"
#include "stages/beam/owner_rules_cost.h"
#include "stages/cost/counted_mask.h"
#include "stages/data/pooled_pixels.h"

namespace beampipe {

// How often each operation was done.
struct PooledWork {
  std::uint64_t fragments = 0;
  std::uint64_t whole = 0;                             // of these, triangles that cover their pixel
  std::uint64_t masks = 0;                             // fragments of pixels that several surfaces may share
  std::uint64_t claims = 0;                            // fragments that take a position
  std::uint64_t covers = 0;                            // of these, triangles that cover a pixel in front of everything
  std::array<std::uint64_t, 6> splits{};               // by bit planes: pixels that were taken apart
  std::array<std::uint64_t, kMostStates + 1> joins{};  // by states: pixels that were put together
  std::uint64_t masks_tested = 0;                      // states whose positions were intersected with a fragment's mask
  std::uint64_t wins = 0;                              // owners that are farther than a fragment in the whole pixel
  std::uint64_t takes = 0;                             // states that a claim was taken away from
  std::uint64_t planes = 0;                            // of owners, computed again
  std::uint64_t contests = 0;                          // owners of positions that a fragment covers
  std::uint64_t planes_compared = 0;                   // at all positions
  std::uint64_t listed = 0;                            // owners whose positions were counted
  std::uint64_t words_scanned = 0;                     // pixels that collections looked at
  std::uint64_t finality_tests = 0;                    // of owners, against the watermark
  std::uint64_t farthest_found = 0;                    // farthest depths over an owner's positions
  std::uint64_t measured = 0;                          // owners whose mean position was found
  std::uint64_t pairs_compared = 0;                    // of owners
  std::uint64_t ties = 0;                              // of these pairs, with the least loss so far
  std::uint64_t merges = 0;                            // of two owners
  std::uint64_t fractions = 0, order_tests = 0;        // to sort owners that become final
  std::uint64_t retirements = 0;                       // of one owner or of several at once
  std::uint64_t retired = 0;                           // owners that became final
  std::uint64_t bounds_found = 0;                      // depth bounds of the owners of pixels without empty positions
  std::uint64_t vertices_bounded = 0;                  // owners whose vertices limit these bounds
  std::array<std::uint64_t, 6> specks{};               // by bit planes of the pixel's record
  std::uint64_t speck_comparisons = 0;
  std::uint64_t specks_seen = 0;                    // some position next to them votes for them
  std::uint64_t specks_added = 0;                   // of these, specks that add to the pixel's area
  std::uint64_t speck_depths = 0;                   // comparisons with the nearest depth of a pixel's specks
  std::uint64_t finished = 0;                       // pixels that were read at the end
  std::uint64_t limited = 0;                        // pixels whose estimates were compared
  std::uint64_t bytes_read = 0, bytes_written = 0;  // of words and records
};

// The costs of the rules: each is run once on numbers that count.
namespace pooled_costs {

using Number = Counted<float>;
using Bits = Counted<std::uint32_t>;
using Integer = Counted<std::int32_t>;

// Calls rule(one, counts) with a number that counts.
template <class Rule>
OperationCounts of(Rule&& rule) {
  return count_operations([&](OperationCounts& counts) { rule(Number(1.0f, counts), counts); });
}

inline SurfaceArea<Number> area_of(const Number& one) { return {one, one, one}; }

// The cost for each of `count` sizes.
template <class Cost>
std::vector<UnitCost> by_size(std::size_t count, Cost&& cost) {
  std::vector<UnitCost> costs;
  for (std::size_t size = 0; size < count; ++size) costs.emplace_back(cost(size));
  return costs;
}

// What a rule does on masks of so many words.
template <class Rule>
OperationCounts of_masks(std::size_t words, Rule&& rule) {
  return count_operations([&](OperationCounts& counts) { rule(CountedMask{words, &counts}); });
}

// The slot of a fragment that takes a position: the error of its mask, and its centroid.
inline OperationCounts slot() {
  return of([](const Number& one, OperationCounts& counts) {
    const Bits bits(0, counts);
    OwnerSlot::words_of(bits, one * one - one, bits, one, one);
  });
}

// The mean of an owner's positions, from the sums of their coordinates.
inline OperationCounts mean() {
  return of([](const Number& one, OperationCounts& counts) {
    for (int axis = 0; axis < 2; ++axis) mean_position(Integer(0, counts), one) - Number(0.5f);
  });
}

// The sides of an area, from sums of squares.
inline OperationCounts sides() {
  return of([](const Number& one, OperationCounts& counts) {
    const Integer sum(0, counts);
    sides_of({sum, sum}, {sum, sum, sum}, one, one);
  });
}

// What a slot is, for rounding.
inline Bits content(OperationCounts& counts) { return OwnerSlot::content_of(Bits(0, counts), Bits(0, counts)); }

// Two surfaces become one: their positions, their parts, and their slot.
inline OperationCounts merge(std::size_t words) {
  OperationCounts cost = of([](const Number& one, OperationCounts& counts) {
    const Number color[] = {one, one, one};
    merged_slot(Bits(0, counts), merged_parts(area_of(one), area_of(one), false), color, color, content(counts),
                content(counts));
  });
  cost += of_masks(words, [](const CountedMask& mask) { mask | mask; });
  return cost;
}

// Of two pairs that lose the same, whose surfaces lie closer in the trace?
inline OperationCounts tie() {
  return of([](const Number&, OperationCounts& counts) {
    const Integer number(0, counts);
    static_cast<void>(distance_in_trace(number, number) < distance_in_trace(number, number));
  });
}

// What part of what its triangle covers a surface shows.
inline OperationCounts fraction() {
  return of([](const Number& one, OperationCounts&) { area_of(one).fraction(); });
}

inline FinalSums<Integer, Bits> sums(OperationCounts& counts) {
  FinalSums<Integer, Bits> all{Integer(0, counts), {}};
  all.colors.fill(Bits(0, counts));
  return all;
}

// An owner that is retired: it is added to the sums, and its positions to those that are final.
inline OperationCounts retirement(std::size_t words) {
  OperationCounts cost = of([](const Number& one, OperationCounts& counts) {
    FinalSums<Integer, Bits> all = sums(counts);
    const Number color[] = {one, one, one};
    add_final(area_of(one), color, content(counts), one, one, all);
    one + one;  // the count of final positions
  });
  cost += of_masks(words, [](const CountedMask& mask) { mask | mask; });
  return cost;
}

// A speck that is seen, and what it takes if it adds to the pixel.
inline OperationCounts seen_speck() {
  return of([](const Number& one, OperationCounts& counts) {
    Integer same(0, counts);
    add_speck_area(one, one, speck_threshold(one, one), Integer(0, counts), Integer(0, counts), same) > Number(0.0f);
  });
}
inline OperationCounts added_speck() {
  return of([](const Number& one, OperationCounts& counts) {
    FinalSums<Integer, Bits> all = sums(counts);
    const Number zero(0.0f);
    all.add(one, {one * one, one * one, one * one, zero, zero, zero}, one);
  });
}

}  // namespace pooled_costs

// Of a footprint: the squares of its positions, summed up, and its sides.
inline OperationCounts footprint_cost(std::size_t words) {
  OperationCounts cost = OperationCounts{.mul_add = 3} * (32 * words);
  return cost += pooled_costs::sides();
}

template <std::size_t Words>
void charge(const PooledWork& work, StageCounters& counters) {
  constexpr std::uint64_t kPositions = 32 * Words;
  using namespace pooled_costs;
  static const std::vector<UnitCost> of_split =
                                         by_size(6, [](std::size_t planes) { return split_cost(planes, Words); }),
                                     of_join = by_size(kMostStates + 1,
                                                       [](std::size_t states) { return join_cost(states, Words); }),
                                     of_votes = by_size(6, speck_votes_cost);
  static const UnitCost of_count = count_cost(Words), of_plane = plane_cost(), of_contest = plane_gap_cost(),
                        of_slot = slot(), of_nearer = nearer_cost() * kPositions, of_finality = finality_cost(),
                        of_farthest = farthest_cost() * kPositions, of_mean = mean(), of_pair = pair_cost(),
                        of_tie = tie(), of_merge = merge(Words), of_fraction = fraction(),
                        of_retirement = retirement(Words), of_bounds = plane_bounds_cost(),
                        of_vertices = vertex_bounds_cost(), of_speck_test = speck_test_cost(),
                        of_seen_speck = seen_speck(), of_added_speck = added_speck(), of_limit = limit_cost();
  static const UnitCost of_meeting = of_masks(Words, [](const CountedMask&mask) { is_met(mask, mask); }),
                        of_win = of_masks(Words, [](const CountedMask&mask) { with_won(mask, mask, mask); }),
                        of_claim = of_masks(Words, [](const CountedMask&mask) { claim_of(mask, mask, mask).none(); }),
                        of_take = of_masks(Words, [](CountedMask mask) { take_from(mask, mask); });
  constexpr OperationCounts kOfComparison{.add = 1}, kOfPosition{.add = 2};  // its x and y
  counters.items_in += work.fragments;
  counters.items_out += work.claims;
  for (std::size_t planes = 0; planes < work.splits.size(); ++planes)
    counters.ops += of_split[planes] * work.splits[planes];
  for (std::size_t states = 0; states < work.joins.size(); ++states)
    counters.ops += of_join[states] * work.joins[states];
  // Finished pixels are known by their closed depths, too.
  const std::uint64_t looked_at = work.fragments + work.words_scanned + work.finished;
  // Whether closed pixels hide something, shares of owners that become final, places in the trace, which owner is the
  // farthest one, and which speck the nearest.
  counters.ops +=
      kOfComparison * (looked_at + work.order_tests + work.planes_compared + work.bounds_found + work.speck_depths);
  counters.ops += of_meeting * work.masks_tested;
  counters.ops += of_win * (work.wins + work.planes_compared);
  counters.ops += of_claim * work.masks;
  counters.ops += of_take * work.takes;
  counters.ops += of_plane * work.planes;
  counters.ops += of_contest * work.contests;
  counters.ops += of_nearer * work.planes_compared;
  counters.ops += of_count * (work.listed + work.retirements + work.limited);
  counters.ops += of_count * (work.claims - work.covers);  // the positions that the fragment covers
  counters.ops += of_slot * (work.claims - work.covers);
  counters.ops += of_finality * work.finality_tests;
  counters.ops += of_farthest * work.farthest_found;
  counters.ops += kOfPosition * (kPositions * work.measured);
  counters.ops += of_mean * work.measured;
  counters.ops += of_pair * work.pairs_compared;
  counters.ops += of_tie * work.ties;
  counters.ops += of_merge * work.merges;
  counters.ops += of_fraction * work.fractions;
  counters.ops += of_retirement * work.retired;
  counters.ops += of_bounds * work.bounds_found;  // their planes are among work.planes
  counters.ops += of_vertices * work.vertices_bounded;
  for (std::size_t planes = 0; planes < work.specks.size(); ++planes)
    counters.ops += of_votes[planes] * work.specks[planes];
  counters.ops += of_speck_test * work.speck_comparisons;
  counters.ops += of_seen_speck * work.specks_seen;
  counters.ops += of_added_speck * work.specks_added;
  counters.ops += of_limit * work.limited;
  counters.bytes_read += (work.fragments - work.whole) * owners_fragment_bytes(Words) +
                         work.whole * kOwnersWholeFragmentBytes + looked_at * (sizeof(float) + kPixelWordBytes) +
                         work.bytes_read;
  counters.bytes_read += work.planes * (sizeof(std::uint32_t) + sizeof(ScreenDepth)) +  // by its number in the list
                         work.vertices_bounded * sizeof(SetupTriangle::vertex_z);
  counters.bytes_written += work.bytes_written;
  counters.position_tests += kPositions * (work.planes_compared + work.farthest_found);
  counters.lanes_used += work.claims;
  counters.lanes_issued += work.fragments;
}

}  // namespace beampipe
