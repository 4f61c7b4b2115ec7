#include "stages/raster/conservative_raster.h"

#include "stages/beam/beam_fragment.h"
#include "stages/raster/pair_bounds.h"
#include "stages/raster/raster_cost.h"
#include "stages/raster/traverse.h"

namespace beampipe {
namespace {

void set_depths(const SetupTriangle& triangle, const DepthBounds<float>& vertices, PixelTriangle& pair) {
  const DepthBounds<float> bounds = pair_bounds(pixel_plane(triangle, pair.x, pair.y), vertices);
  pair.nearest = bounds.nearest, pair.farthest = bounds.farthest;
}

}  // namespace

std::size_t conservative_raster(const SetupTriangles& triangles, const TriangleList& list, const Tile& tile,
                                StageCounters& counters, std::vector<PixelTriangle>& out, ClosedDepth* closed,
                                PairDepths depths) {
  const std::size_t before = out.size();
  std::uint32_t quad = 0;
  TraversalCounts counts;
  for (const std::uint32_t index : list) {
    const SetupTriangle& triangle = triangles.triangles[index];
    const DepthBounds<float> vertices = vertex_bounds(triangle.vertex_z);
    if (closed && closed->hides_everywhere(vertices.nearest)) continue;
    traverse(triangle, EdgeSet(triangle), tile, CellGrid{}, FullMeans::area, quad, counts,
             [&](std::int32_t x, std::int32_t y, std::uint32_t q, bool full) {
               PixelTriangle pair{index, q, x, y, full, 0, 0};
               if (depths == PairDepths::bounds) set_depths(triangle, vertices, pair);
               if (closed && closed->hides(x, y, pair.nearest)) return;
               if (closed && full) closed->close(x, y, pair.farthest);
               out.push_back(pair);
             });
    if (closed) closed->refresh();
  }
  const std::size_t waited = out.size();
  const std::uint32_t pair_bytes = depths == PairDepths::bounds ? kPairWithDepthBytes : kPixelTriangleBytes;
  if (closed) {  // what was closed later than it was found
    counters.bytes_read += waited * pair_bytes;
    std::erase_if(out, [&](const PixelTriangle& pair) { return closed->hides(pair.x, pair.y, pair.nearest); });
    closed->charge(counters);
  }
  counters.ops += traversal_cost(counts, FullMeans::area);
  if (depths == PairDepths::bounds) {
    static const UnitCost vertices_cost = vertex_bounds_cost(), bounds_cost = pair_bounds_cost();
    counters.ops += vertices_cost * list.size();
    counters.ops += bounds_cost * counts.cells_touched;
  }
  counters.lanes_used += counts.cells_touched;
  counters.lanes_issued += counts.cells_tested;
  counters.items_out += out.size() - before;
  counters.bytes_written += (out.size() - before) * pair_bytes;
  return waited;
}

PixelTriangle pixel_triangle(const SetupTriangles& triangles, std::uint32_t index, std::uint32_t quad, std::int32_t x,
                             std::int32_t y, bool full) {
  const SetupTriangle& triangle = triangles.triangles[index];
  PixelTriangle pair{index, quad, x, y, full, 0, 0};
  set_depths(triangle, vertex_bounds(triangle.vertex_z), pair);
  return pair;
}

}  // namespace beampipe
