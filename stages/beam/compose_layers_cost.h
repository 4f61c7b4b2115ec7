// What compose_layers is charged.
#pragma once

#include "stages/beam/casav_merges.h"
#include "stages/cost/counting.h"
#include "stages/data/casav_aggregate.h"

namespace beampipe {

// How often each operation was done.
struct LayersWork {
  std::uint64_t fragments = 0;
  MergeWork merging;
  std::uint64_t finished = 0;  // pixels whose aggregates were read and merged at the end
};

// Per fragment, for each layer: is it nearer, and how close are it and the next one?
inline OperationCounts layer_cost() {
  return count_operations([](OperationCounts& counts) {
    const Counted<float> one(1.0f, counts);
    AggregateOf<Counted<float>, Counted<std::uint32_t>> layer;
    layer.z_min = layer.z_max = one;
    static_cast<void>(layer.z_min <= one);
    static_cast<void>(depth_between(layer, layer) < one);
  });
}

inline void charge(const LayersWork& work, std::size_t layers, const MergeRules& rules, CasavStorage storage,
                   StageCounters& counters) {
  const std::uint64_t pixel_bytes = layers * casav_aggregate_bytes(storage);
  counters.items_in += work.fragments;
  counters.items_out += work.fragments;
  counters.ops += casav_merges_cost(work.merging, rules, storage);
  counters.position_tests += position_tests(work.merging);
  if (layers > 1) counters.ops += layer_cost() * (layers * work.fragments);
  counters.bytes_read += work.fragments * (casav_aggregate_bytes(storage) + pixel_bytes) + work.finished * pixel_bytes;
  counters.bytes_written += work.fragments * pixel_bytes;
  counters.lanes_used += work.fragments;
  counters.lanes_issued += work.fragments;
}

}  // namespace beampipe
