// What alpha_mask is charged.
#pragma once

#include "stages/cost/counting.h"

namespace beampipe {

// How often each part ran.
struct AlphaMaskWork {
  std::uint64_t fragments = 0;   // that are not opaque
  std::uint64_t positions = 0;   // tested by a texture fetch each
  std::uint64_t ranked = 0;      // positions that were chosen by opacity alone
  std::uint64_t footprints = 0;  // fragments of which the mean alpha was fetched
  std::uint64_t dropped = 0;
};

// Texture coordinates at a point: three planes, a division, two products, and two interpolations; then the fetch and
// the factor.
inline OperationCounts alpha_cost() { return {.mul_add = 6 + 2 + 4 + 1, .add = 0, .bit = 0, .fetch = 1, .special = 1}; }

// The rank of a position is read from a table of the draw's dimension, flipped, and compared.
inline OperationCounts rank_cost() { return {.add = 1, .bit = 1, .fetch = 1}; }

// `words`: of a mask.
inline void charge(const AlphaMaskWork& work, std::size_t words, StageCounters& counters) {
  counters.items_in += work.fragments;
  counters.items_out += work.fragments - work.dropped;
  counters.ops += (alpha_cost()) * (work.positions + work.footprints);
  counters.ops += rank_cost() * (work.positions + work.ranked);
  counters.bytes_read += work.fragments * (4 * words + 2);
  counters.bytes_written += (work.fragments - work.dropped) * (4 * words + 2);
  counters.lanes_used += work.positions + work.ranked;
  counters.lanes_issued += work.positions + work.ranked;
}

}  // namespace beampipe
