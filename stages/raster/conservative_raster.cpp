#include "stages/raster/conservative_raster.h"

#include "simd/prefetch.h"
#include "stages/raster/conservative_raster_cost.h"
#include "stages/raster/traverse.h"

namespace beampipe {

std::size_t conservative_raster(const SetupTriangles& triangles, const TriangleList& list, const Tile& tile,
                                StageCounters& counters, std::vector<Pair>& out, const ConservativeOptions& options) {
  ClosedDepth* const closed = options.closed;
  const bool closes = closed && options.closing == Closing::by_raster;
  const std::size_t before = out.size();
  Traversal traversal{tile};
  ConservativeRasterWork work;
  constexpr std::size_t kAhead = 6;  // triangles
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (i + kAhead < list.size()) prefetch(triangles.triangles[list[i + kAhead]]);
    const std::uint32_t index = list[i];
    const SetupTriangle& triangle = triangles.triangles[index];
    const DepthBounds<float> vertices = vertex_bounds(triangle.vertex_z);
    if (closed && closed->hides_everywhere(vertices.nearest)) continue;
    const bool is_opaque = triangles.is_opaque(index);
    traverse(triangle, EdgeSet(triangle), traversal, [&](std::int32_t x, std::int32_t y, std::uint32_t q, bool covers) {
      const bool full = covers && is_opaque;
      DepthBounds<float> bounds{};
      if (options.depths == PairDepths::bounds) bounds = pair_bounds(pixel_plane(triangle, x, y), vertices);
      if (closed && closed->hides(x, y, bounds.nearest)) return;
      if (closes && full) closed->close(x, y, bounds.farthest);
      Pair& pair = out.emplace_back();
      pair = {.triangle = index,
              .quad = q,
              .x = x,
              .y = y,
              .full = full,
              .nearest = bounds.nearest,
              .farthest = bounds.farthest};
    });
    if (closed) closed->refresh();
  }
  const std::size_t waited = out.size();
  if (closes) {  // pixels may have been closed after a pair was found in them
    work.tested_again = waited;
    std::erase_if(out, [&](const Pair& pair) { return closed->hides(pair.x, pair.y, pair.nearest); });
  }
  if (closed) charge(*closed, counters);
  work.traversal = traversal.counts;
  work.triangles = list.size();
  work.pairs = out.size() - before;
  charge(work, options.depths, counters);
  return waited;
}

}  // namespace beampipe
