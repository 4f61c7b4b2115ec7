// What conservative_raster is charged, besides its use of closed depths.
#pragma once

#include "stages/cost/closed_depth_cost.h"
#include "stages/cost/plane_cost.h"
#include "stages/raster/conservative_raster.h"
#include "stages/raster/traverse_cost.h"

namespace beampipe {

struct ConservativeRasterWork {
  TraversalCounts traversal;
  std::uint64_t triangles = 0;
  std::uint64_t tested_again = 0;  // pairs that were read again to test whether they are hidden by now
  std::uint64_t pairs = 0;         // that are passed on
};

inline void charge(const ConservativeRasterWork& work, PairDepths depths, StageCounters& counters) {
  const std::uint32_t pair_bytes = depths == PairDepths::bounds ? kPairWithDepthBytes : kPairBytes;
  counters.items_out += work.pairs;
  counters.ops += traversal_cost(work.traversal, FullMeans::area);
  if (depths == PairDepths::bounds) {
    static const UnitCost of_vertices = vertex_bounds_cost(), of_pair = pair_bounds_cost();
    counters.ops += of_vertices * work.triangles;
    counters.ops += of_pair * work.traversal.cells_touched;
  }
  counters.bytes_read += work.tested_again * pair_bytes;
  counters.bytes_written += work.pairs * pair_bytes;
  counters.lanes_used += work.traversal.cells_touched;
  counters.lanes_issued += work.traversal.cells_tested;
}

}  // namespace beampipe
