// What compose and compose_over are charged.
#pragma once

#include "simd/merge.h"
#include "stages/beam/compose_paper.h"
#include "stages/cost/counting.h"

namespace beampipe {

inline FragmentOf<Counted<float>, Counted<std::uint32_t>> counted_fragment(OperationCounts& counts) {
  const Counted<float> one(1.0f, counts);
  const Counted<std::uint32_t> all(~0u, counts);
  return {{one, all, {one, one, one}, one, one, one, {one, one, one}}, all};
}

// How many numbers of a stored aggregate must be converted to float32.
constexpr std::uint64_t packed_numbers(PaperStorage storage) {
  switch (storage) {
    case PaperStorage::slides:
      return 3;  // colour
    case PaperStorage::text:
      return 6;  // colour, slopes, thickness
    case PaperStorage::float32:
      break;
  }
  return 0;
}

// Per merge, with loading and storing the aggregate.
inline OperationCounts merge_cost(const SamplePattern& pattern, const MergeRules& rules, PaperStorage storage) {
  return count_operations([&](OperationCounts& counts) {
    const auto fragment = counted_fragment(counts);
    merge_formula(fragment, fragment.surface, pattern, rules);
    counts.convert += 2 * packed_numbers(storage);
  });
}

inline OperationCounts over_cost() {
  return count_operations([](OperationCounts& counts) {
    const auto fragment = counted_fragment(counts);
    over_formula(fragment, fragment.surface);
    counts.convert += 2 * 3;  // fp16 colour
  });
}

// `cost`: of one merge.
inline void charge_merges(const ABuffer& buffer, const OperationCounts& cost, std::uint32_t fragment_bytes,
                          std::uint32_t aggregate_bytes, StageCounters& counters) {
  const std::uint64_t merges = buffer.records.size(), pixels = buffer.first.size() - 1;
  counters.items_in += merges;
  counters.items_out += pixels;
  counters.ops += cost * merges;
  counters.bytes_read += merges * fragment_bytes;
  counters.bytes_written += pixels * aggregate_bytes;
  counters.lanes_used += merges;
  counters.lanes_issued += merges;
}

}  // namespace beampipe
