// What a stage is charged for its use of closed depths.
#pragma once

#include "stages/cost/counters.h"
#include "stages/data/closed_depth.h"

namespace beampipe {

// Charges the work since the last call. Every test and every closing reads a depth and compares it. A pixel that
// changes takes a second comparison, with the tile's depth. A refresh reads and compares every pixel twice.
inline void charge(ClosedDepth& closed, StageCounters& counters) {
  const ClosedDepthWork work = closed.take_work();
  counters.ops.add += work.pixel_tests + work.tile_tests + work.closings + work.changes + 2 * work.refreshed_pixels;
  counters.bytes_read += (work.pixel_tests + work.closings + 2 * work.refreshed_pixels) * sizeof(float);
  counters.bytes_written += work.changes * sizeof(float);
  counters.hidden_items += work.hidden;
  counters.hidden_triangles += work.hidden_everywhere;
}

}  // namespace beampipe
