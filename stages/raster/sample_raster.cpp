#include "stages/raster/sample_raster.h"

#include "simd/sample_mask.h"
#include "stages/raster/pair_bounds.h"
#include "stages/raster/raster_cost.h"

namespace beampipe {
namespace {

CellEdges cell_edges(const EdgeSet& set, std::int64_t x, std::int64_t y) {
  CellEdges cell;
  for (std::size_t k = 0; k < 3; ++k) {
    const Edge& edge = set.edges[k];
    cell.a[k] = edge.a, cell.b[k] = edge.b;
    cell.c[k] = edge.at(x, y) - (edge.owns ? 0 : 1);
  }
  return cell;
}

// Between these the depths of all the triangle's samples lie as the depth test rounds them: it computes them in single
// precision from a corner of the cell, a pixel's slopes away at most.
DepthBounds<float> sample_bounds(const SetupTriangle& triangle) {
  const auto& z = triangle.vertex_z;
  return sample_bounds(vertex_bounds(z), triangle.depth.dzdx, triangle.depth.dzdy);
}

OperationCounts sample_test_cost(const SamplePattern& pattern) {
  return count_operations([&](OperationCounts& counts) {
    using Int = Counted<std::int64_t>;
    const Int zero(0, counts), edges[3] = {zero, zero, zero};
    Int corner[3];
    for (Int& value : corner) value = zero - zero;  // the top-left rule
    sample_mask_scalar(edges, edges, corner, pattern);
  });
}

}  // namespace

void sample_raster(const SetupTriangles& triangles, const TriangleList& list, const Tile& tile,
                   const Sampling& sampling, StageCounters& counters, std::vector<SampleFragment>& out,
                   ClosedDepth* closed) {
  const SamplePattern& pattern = sampling.pattern;
  const std::uint32_t every_sample = ~0u >> (kMaxMaskSamples - pattern.count);
  const std::size_t before = out.size();
  std::uint32_t quad = 0;
  TraversalCounts counts;
  std::vector<CellEdges> partial;        // cells that need the sample test,
  std::vector<std::size_t> destination;  // and where their masks go
  for (const std::uint32_t index : list) {
    const SetupTriangle& triangle = triangles.triangles[index];
    const DepthBounds<float> depths = sample_bounds(triangle);
    if (closed && closed->hides_everywhere(depths.nearest)) continue;
    const EdgeSet set(triangle);
    traverse(triangle, set, tile, sampling.grid, FullMeans::samples, quad, counts,
             [&](std::int32_t x, std::int32_t y, std::uint32_t q, bool full) {
               if (closed && closed->hides(x, y, depths.nearest)) return;
               if (closed && full) closed->close(x, y, depths.farthest);
               if (!full) {
                 partial.push_back(cell_edges(set, std::int64_t{x} * sampling.grid.cell_width(),
                                              std::int64_t{y} * sampling.grid.cell_height()));
                 destination.push_back(out.size());
               }
               out.push_back({index, q, x, y, every_sample});
             });
    if (closed) closed->refresh();
  }
  std::vector<std::uint32_t> masks(partial.size());
  sample_masks(partial.data(), partial.size(), pattern, masks.data());
  for (std::size_t i = 0; i < masks.size(); ++i) out[destination[i]].mask = masks[i];
  const auto start = out.begin() + static_cast<std::ptrdiff_t>(before);
  out.erase(std::remove_if(start, out.end(), [](const SampleFragment& f) { return f.mask == 0; }), out.end());

  counters.items_out += out.size() - before;
  counters.ops += traversal_cost(counts, FullMeans::samples);
  counters.ops += sample_test_cost(pattern) * partial.size();
  if (closed) {
    static const UnitCost bounds_cost = sample_bounds_cost();
    counters.ops += bounds_cost * list.size();
    closed->charge(counters);
  }
  counters.bytes_written += (out.size() - before) * kSampleFragmentBytes;
  counters.lanes_issued += partial.size() * static_cast<std::size_t>(pattern.count);
  for (const std::uint32_t mask : masks) counters.lanes_used += static_cast<std::uint64_t>(std::popcount(mask));
}

}  // namespace beampipe
