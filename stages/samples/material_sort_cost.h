// What material_sort is charged.
#pragma once

#include "stages/cost/counting.h"
#include "stages/data/pixel_formats.h"

namespace beampipe {

inline constexpr std::size_t kSortDigits = 256;  // values of a digit

template <class Int>
Int digit_of(Int material, int shift) {
  return material >> shift & Int(kSortDigits - 1);
}

// An item in the modelled machine: a material and a sample, 32 bits each. A count has 32 bits.
inline constexpr std::uint64_t kSortItemBytes = 4 + 4, kSortCountBytes = 4;

// Bytes that the passes move between bins: every pass but the first one reads its items, and every pass writes them.
inline std::uint64_t sort_item_bytes(std::uint64_t items, std::uint64_t passes) {
  return (2 * passes - 1) * items * kSortItemBytes;
}
// The counts of a bin, which are written and, for the sums, read.
inline std::uint64_t sort_count_bytes(std::uint64_t passes) { return 2 * passes * kSortDigits * kSortCountBytes; }

// Per sample: whether it shows a triangle.
constexpr OperationCounts kSortTest{.add = 1};

// Per sample that shows a triangle: the triangle's material.
constexpr OperationCounts kSortMaterial{.fetch = 1};

// Per item and pass: its digit and that digit's count, which goes up by one; then the same for its place.
inline OperationCounts sort_item_cost() {
  return count_operations([](OperationCounts& counts) {
    const Counted<std::uint32_t> material(0, counts), one(1);
    const std::uint32_t table[1] = {};
    for (int i = 0; i < 2; ++i) {
      digit_of(material, 0);
      fetch(table, Counted<std::int32_t>(0, counts)) + one;
    }
  });
}

// Per digit and pass: the sum of the counts of smaller digits, and that of earlier bins.
constexpr OperationCounts kSortSum{.add = 2};

inline void charge_material_sort(std::uint64_t samples, std::uint64_t items, std::uint64_t passes,
                                 StageCounters& counters) {
  constexpr std::uint64_t kMaterialBytes = 4;
  counters.items_in += samples;
  counters.items_out += items;
  counters.ops += kSortTest * samples;
  counters.ops += kSortMaterial * items;
  counters.ops += sort_item_cost() * (items * passes);
  counters.ops += kSortSum * (kSortDigits * passes);
  counters.bytes_read += samples * kVisibilityBytes + items * kMaterialBytes + (passes - 1) * items * kSortItemBytes +
                         sort_count_bytes(passes) / 2;
  counters.bytes_written += passes * items * kSortItemBytes + sort_count_bytes(passes) / 2;
  counters.lanes_used += items;
  counters.lanes_issued += samples;
}

}  // namespace beampipe
