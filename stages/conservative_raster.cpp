#include "stages/conservative_raster.h"

#include "stages/raster_cost.h"
#include "stages/traverse.h"

namespace beampipe {

void conservative_raster(const SetupTriangles& triangles, const TriangleList& list, const Tile& tile,
                         StageCounters& counters, std::vector<PixelTriangle>& out) {
  const std::size_t before = out.size();
  std::uint32_t quad = 0;
  TraversalCounts counts;
  for (const std::uint32_t index : list) {
    const SetupTriangle& triangle = triangles.triangles[index];
    traverse(triangle, EdgeSet(triangle), tile, CellGrid{}, FullMeans::area, quad, counts,
             [&](std::int32_t x, std::int32_t y, std::uint32_t q, bool full) {
               out.push_back({index, q, x, y, full});
             });
  }
  counters.items_out += out.size() - before;
  counters.ops += cell_test_cost() * counts.cells_tested;
  counters.bytes_written += (out.size() - before) * kPixelTriangleBytes;
  counters.lanes_used += counts.cells_touched;
  counters.lanes_issued += counts.cells_tested;
}

}  // namespace beampipe
