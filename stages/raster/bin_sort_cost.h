// What bin_sort is charged.
#pragma once

#include "stages/cost/counting.h"
#include "stages/cost/plane_cost.h"

namespace beampipe {

inline constexpr std::uint64_t kSortPasses = 3;  // 8 bits of the key at a time
inline constexpr std::uint64_t kKeyBytes = 4;    // a key of 24 bits takes a word of the list

// The plane at the middle of the bin, its margin, its reach, the depths of the vertices, and the key's bits.
inline OperationCounts key_cost() {
  OperationCounts cost = pair_bounds_cost();
  cost += vertex_bounds_cost();
  cost.mul_add += 2;                           // the reach over the bin's width and height
  cost += {.mul_add = 1, .add = 3, .bit = 3};  // the margin: a sum of three magnitudes, times a constant
  cost.bit += 2;                               // a shift and a complement
  return cost;
}

// In each pass, per triangle: its digit, the counter of this digit, and its place.
inline constexpr OperationCounts kPassCost{.add = 2, .bit = 2, .fetch = 2};

inline void charge_bin_sort(std::uint64_t triangles, StageCounters& counters) {
  static const UnitCost of_key = key_cost();
  constexpr std::uint64_t kEntryBytes = sizeof(std::uint32_t) + kKeyBytes;
  counters.items_in += triangles;
  counters.items_out += triangles;
  counters.ops += of_key * triangles;
  counters.ops += kPassCost * (kSortPasses * triangles);
  counters.bytes_read += kSortPasses * kEntryBytes * triangles;
  counters.bytes_written += (kKeyBytes + kSortPasses * kEntryBytes) * triangles;
}

}  // namespace beampipe
