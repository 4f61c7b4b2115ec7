// What sample_raster is charged, besides its use of closed depths.
#pragma once

#include "simd/sample_mask.h"
#include "stages/cost/closed_depth_cost.h"
#include "stages/cost/plane_cost.h"
#include "stages/data/sample_fragment.h"
#include "stages/raster/traverse_cost.h"

namespace beampipe {

struct SampleRasterWork {
  TraversalCounts traversal;
  std::uint64_t partial_cells = 0;    // touched cells that are not full, whose samples are tested
  std::uint64_t covered_samples = 0;  // of the partial cells
  std::uint64_t fragments = 0;        // that are passed on
};

// The test of a cell's samples, including the top-left rule at the cell's corner.
inline OperationCounts sample_test_cost(const SamplePattern& pattern) {
  return count_operations([&](OperationCounts& counts) {
    using Int = Counted<std::int64_t>;
    const Int zero(0, counts), edges[3] = {zero, zero, zero};
    Int corner[3];
    for (Int& value : corner) value = zero - zero;
    sample_mask_scalar(edges, edges, corner, pattern);
  });
}

inline void charge(const SampleRasterWork& work, const SamplePattern& pattern, StageCounters& counters) {
  counters.items_out += work.fragments;
  counters.ops += traversal_cost(work.traversal, FullMeans::samples);
  counters.ops += sample_test_cost(pattern) * work.partial_cells;
  counters.bytes_written += work.fragments * kSampleFragmentBytes;
  counters.lanes_used += work.covered_samples;
  counters.lanes_issued += work.partial_cells * static_cast<std::uint64_t>(pattern.count);
}

// The depth bounds of the triangles, which only closed depths need.
inline void charge_bounds(std::uint64_t triangles, StageCounters& counters) {
  static const UnitCost of_triangle = sample_bounds_cost();
  counters.ops += of_triangle * triangles;
}

}  // namespace beampipe
