// What compose and compose_over are charged.
#pragma once

#include "stages/beam/casav_fragment.h"
#include "stages/beam/casav_merges.h"
#include "stages/beam/compose_casav.h"
#include "stages/cost/counting.h"

namespace beampipe {

inline OperationCounts over_cost() {
  return count_operations([](OperationCounts& counts) {
    const auto fragment = counted_fragment(counts);
    over_formula(fragment, fragment.surface);
    counts.convert += 2 * 3;  // fp16 colour
  });
}

// `cost`: of all merges.
inline void charge_merges(const ABuffer& buffer, const OperationCounts& cost, std::uint32_t fragment_bytes,
                          std::uint32_t aggregate_bytes, StageCounters& counters) {
  const std::uint64_t merges = buffer.records.size(), pixels = buffer.first.size() - 1;
  counters.items_in += merges;
  counters.items_out += pixels;
  counters.ops += cost;
  counters.bytes_read += merges * fragment_bytes;
  counters.bytes_written += pixels * aggregate_bytes;
  counters.lanes_used += merges;
  counters.lanes_issued += merges;
}

}  // namespace beampipe
