#include "stages/conservative_raster.h"

#include "stages/beam_fragment.h"
#include "stages/raster_cost.h"
#include "stages/traverse.h"

namespace beampipe {
namespace {

// The nearest and the farthest vertex.
struct VertexDepths {
  float nearest, farthest;
  explicit VertexDepths(const SetupTriangle& triangle)
      : nearest(std::min({triangle.vertex_z[0], triangle.vertex_z[1], triangle.vertex_z[2]})),
        farthest(std::max({triangle.vertex_z[0], triangle.vertex_z[1], triangle.vertex_z[2]})) {}
};

void set_depths(const SetupTriangle& triangle, const VertexDepths& vertices, PixelTriangle& pair) {
  const DepthPlane<float> plane = pixel_plane(triangle, pair.x, pair.y);
  const float reach = 0.5f * (magnitude(plane.dzdu) + magnitude(plane.dzdv));
  pair.nearest = lesser(greater(plane.z - reach, vertices.nearest), vertices.farthest);
  pair.farthest = greater(lesser(plane.z + reach, vertices.farthest), vertices.nearest);
}

}  // namespace

void conservative_raster(const SetupTriangles& triangles, const TriangleList& list, const Tile& tile,
                         StageCounters& counters, std::vector<PixelTriangle>& out, ClosedDepth* closed) {
  const std::size_t before = out.size();
  std::uint32_t quad = 0;
  TraversalCounts counts;
  for (const std::uint32_t index : list) {
    const SetupTriangle& triangle = triangles.triangles[index];
    const VertexDepths vertices(triangle);
    if (closed && closed->hides_everywhere(vertices.nearest)) continue;
    traverse(triangle, EdgeSet(triangle), tile, CellGrid{}, FullMeans::area, quad, counts,
             [&](std::int32_t x, std::int32_t y, std::uint32_t q, bool full) {
               PixelTriangle pair{index, q, x, y, full, 0, 0};
               set_depths(triangle, vertices, pair);
               if (closed && closed->hides(x, y, pair.nearest)) return;
               if (closed && full) closed->close(x, y, pair.farthest);
               out.push_back(pair);
             });
    if (closed) closed->refresh();
  }
  if (closed)  // what was closed later than it was found
    std::erase_if(out, [&](const PixelTriangle& pair) { return closed->hides(pair.x, pair.y, pair.nearest); });
  counters.ops += traversal_cost(counts, FullMeans::area);
  counters.lanes_used += counts.cells_touched;
  counters.lanes_issued += counts.cells_tested;
  counters.items_out += out.size() - before;
  counters.bytes_written += (out.size() - before) * kPixelTriangleBytes;
}

PixelTriangle pixel_triangle(const SetupTriangles& triangles, std::uint32_t index, std::uint32_t quad, std::int32_t x,
                             std::int32_t y, bool full) {
  const SetupTriangle& triangle = triangles.triangles[index];
  PixelTriangle pair{index, quad, x, y, full, 0, 0};
  set_depths(triangle, VertexDepths(triangle), pair);
  return pair;
}

}  // namespace beampipe
