// What bin_sort is charged.
#pragma once

#include "stages/cost/counting.h"
#include "stages/cost/plane_cost.h"

namespace beampipe {

inline constexpr std::uint64_t kSortPasses = 3;  // 8 bits of the key at a time
inline constexpr std::uint64_t kKeyBytes = 4;    // a key of 24 bits takes a word of the list

// The plane at the middle of the bin, its margin, its reach, the depths of the vertices, and the key's bits.
inline OperationCounts nearest_key_cost() {
  OperationCounts cost = pair_bounds_cost();
  cost += vertex_bounds_cost();
  cost.mul_add += 2;                           // the reach over the bin's width and height
  cost += {.mul_add = 1, .add = 3, .bit = 3};  // the margin: a sum of three magnitudes, times a constant
  cost.bit += 2;                               // a shift and a complement
  return cost;
}

// Of vertices, -2..1.
template <class Real>
Real mean_depth(const Real vertex_z[3]) {
  return (vertex_z[0] + vertex_z[1] + vertex_z[2]) * Real(1.0f / 3.0f);
}

// The mean, and the key's bits.
inline OperationCounts mean_key_cost() {
  OperationCounts cost = count_operations([](OperationCounts& counts) {
    const Counted<float> z[3] = {Counted<float>(-1.0f, counts), Counted<float>(-1.0f), Counted<float>(-1.0f)};
    mean_depth(z);
  });
  cost.bit += 2;  // as above
  return cost;
}

// In each pass, per triangle: its digit, the counter of this digit, and its place.
inline constexpr OperationCounts kPassCost{.add = 2, .bit = 2, .fetch = 2};

inline void charge_bin_sort(std::uint64_t triangles, const OperationCounts& of_key, StageCounters& counters) {
  constexpr std::uint64_t kEntryBytes = sizeof(std::uint32_t) + kKeyBytes;
  counters.items_in += triangles;
  counters.items_out += triangles;
  counters.ops += of_key * triangles;
  counters.ops += kPassCost * (kSortPasses * triangles);
  counters.bytes_read += kSortPasses * kEntryBytes * triangles;
  counters.bytes_written += (kKeyBytes + kSortPasses * kEntryBytes) * triangles;
}

}  // namespace beampipe
