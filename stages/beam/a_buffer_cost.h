// What a_buffer is charged.
#pragma once

#include "stages/beam/a_buffer.h"
#include "stages/beam/merge_sort.h"
#include "stages/cost/counting.h"

namespace beampipe {

inline OperationCounts comparison_cost() {
  return count_operations([](OperationCounts& counts) {
    const Counted<float> depth(0.0f, counts);
    comes_first(depth, depth);
  });
}

struct ABufferWork {
  std::uint64_t records = 0, pixels = 0;
  std::uint64_t comparisons = 0;
  std::uint32_t item_bytes = 0, record_bytes = 0;  // as in a_buffer()
};

inline void charge(const ABufferWork& work, StageCounters& counters) {
  static const UnitCost of_comparison = comparison_cost();
  const std::uint64_t record_bytes = work.record_bytes + kLinkBytes;
  counters.items_in += work.records;
  counters.items_out += work.records;
  counters.ops += of_comparison * work.comparisons;
  // To insert: the item and the head link that it replaces. To sort: the whole buffer.
  counters.bytes_read += work.records * (work.item_bytes + kLinkBytes);
  counters.bytes_read += a_buffer_bytes(work.records, work.pixels, work.record_bytes);
  counters.bytes_written += work.records * (kLinkBytes + record_bytes);  // the head link and the record
}

}  // namespace beampipe
