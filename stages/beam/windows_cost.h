// What windows is charged.
#pragma once

#include "stages/beam/merge_sort.h"
#include "stages/beam/windows.h"
#include "stages/cost/counting.h"

namespace beampipe {

inline OperationCounts range_test_cost() {
  return count_operations([](OperationCounts& counts) {
    const Counted<float> depth(0.0f, counts);
    overlaps(depth, depth);
  });
}

inline OperationCounts extension_cost() {
  return count_operations([](OperationCounts& counts) {
    const Counted<float> depth(0.0f, counts);
    greater(depth, depth);
  });
}

inline OperationCounts order_test_cost() {
  return count_operations([](OperationCounts& counts) {
    const Counted<std::uint32_t> index(0, counts);
    comes_first(index, index);
  });
}

// `pairs`: that the windows contain.
inline void charge(const WindowsWork& work, std::uint64_t windows, std::uint64_t pairs, std::uint32_t record_bytes,
                   StageCounters& counters) {
  static const UnitCost of_range_test = range_test_cost(), of_extension = extension_cost(),
                        of_order_test = order_test_cost();
  counters.items_in += pairs;
  counters.items_out += windows;
  counters.ops += of_range_test * work.range_tests;
  counters.ops += of_extension * work.extensions;
  counters.ops += of_order_test * work.order_tests;
  counters.bytes_read += work.reads * (record_bytes + kLinkBytes);
  counters.bytes_written += pairs * kPairWithDepthBytes;
}

}  // namespace beampipe
