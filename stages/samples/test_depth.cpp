#include "stages/samples/test_depth.h"

#include "simd/depth_compare.h"
#include "stages/beam/fragment_geometry.h"
#include "stages/cost/counting.h"
#include "stages/raster/raster_cost.h"

namespace beampipe {
namespace {

// What the kernels read.
std::vector<CellDepth> cell_depths(const SetupTriangles& triangles, const std::vector<SampleFragment>& fragments,
                                   const Tile& tile, const CellGrid& grid) {
  const double cell_width = 1.0 / grid.columns, cell_height = 1.0 / grid.rows;  // pixels; exact
  std::vector<CellDepth> items;
  items.reserve(fragments.size());
  for (const SampleFragment& fragment : fragments) {
    const ScreenDepth& plane = triangles.triangles[fragment.triangle].depth;
    const auto pixel = static_cast<std::int32_t>(tile.index(grid.pixel_x(fragment.x), grid.pixel_y(fragment.y)));
    const double left = fragment.x * cell_width, top = fragment.y * cell_height;
    CellDepth& item = items.emplace_back();
    item.cell = static_cast<std::uint32_t>(pixel * grid.cells_per_pixel() + grid.in_pixel(fragment.x, fragment.y));
    item.mask = fragment.mask;
    item.triangle = fragment.triangle;
    cell_plane(plane.z, plane.dzdx, plane.dzdy, plane.anchor_x, plane.anchor_y, left, top, item.z, item.dzdx,
               item.dzdy);
  }
  return items;
}

void list_accesses(const std::vector<CellDepth>& items, const std::vector<std::uint32_t>& passed,
                   std::vector<SampleAccess>& accesses) {
  accesses.resize(items.size());
  for (std::size_t i = 0; i < items.size(); ++i)
    accesses[i] = {items[i].cell, items[i].triangle, items[i].mask, passed[i]};
}

OperationCounts per_sample_cost() {  // of either test
  return count_operations([](OperationCounts& counts) {
    const Counted<float> one(1.0f, counts);
    Counted<float> depth;
    depth_test_scalar(one, one, one, one, one, one, depth);
  });
}

OperationCounts per_fragment_cost() {
  return count_operations([](OperationCounts& counts) {
    const Counted<double> one(1.0, counts);
    Counted<float> depth, slope_x, slope_y;
    cell_plane(one, one, one, one, one, one, one, depth, slope_x, slope_y);
  });
}

void count(std::size_t fragments, const SampleCounts& samples, std::uint32_t bytes_written,
           const SamplePattern& pattern, StageCounters& counters) {
  counters.items_in += samples.tested;
  counters.items_out += samples.passed;
  counters.ops += per_fragment_cost() * fragments;
  counters.ops += per_sample_cost() * samples.tested;
  counters.bytes_read += samples.tested * kSampleDepthBytes + fragments * kSampleFragmentBytes;
  counters.bytes_written += samples.passed * bytes_written;
  counters.lanes_used += samples.tested;
  counters.lanes_issued += fragments * static_cast<std::size_t>(pattern.count);
}

}  // namespace

SampleTile::SampleTile(const Tile& tile, const Sampling& sampling, std::uint32_t color_bytes_per_sample)
    : samples_per_pixel(static_cast<std::size_t>(sampling.grid.cells_per_pixel() * sampling.pattern.count)),
      color_bytes(color_bytes_per_sample) {
  const std::size_t samples = tile.pixels() * samples_per_pixel + kSampleSlack;
  depth.assign(samples, kFarDepth);
  triangle.assign(samples, kNoTriangle);
}

void depth_test(const SetupTriangles& triangles, const std::vector<SampleFragment>& fragments, const Tile& tile,
                const Sampling& sampling, StageCounters& counters, SampleTile& surface,
                std::vector<SampleAccess>& accesses) {
  const std::vector<CellDepth> items = cell_depths(triangles, fragments, tile, sampling.grid);
  std::vector<std::uint32_t> masks(items.size());
  const SampleCounts samples = depth_test(items.data(), items.size(), sampling.pattern,
                                          {surface.depth.data(), surface.triangle.data()}, masks.data());
  list_accesses(items, masks, accesses);
  count(items.size(), samples, kSampleDepthBytes + surface.color_bytes, sampling.pattern, counters);
}

void depth_test_equal(const SetupTriangles& triangles, const Tile& tile, const Sampling& sampling,
                      StageCounters& counters, const SampleTile& surface, std::vector<SampleFragment>& fragments,
                      std::vector<SampleAccess>& accesses) {
  const std::vector<CellDepth> items = cell_depths(triangles, fragments, tile, sampling.grid);
  std::vector<std::uint32_t> masks(items.size());
  const SampleCounts samples =
      depth_equal(items.data(), items.size(), sampling.pattern, surface.depth.data(), masks.data());
  list_accesses(items, masks, accesses);
  for (std::size_t i = 0; i < masks.size(); ++i) fragments[i].mask = masks[i];
  std::erase_if(fragments, [](const SampleFragment& fragment) { return fragment.mask == 0; });
  count(items.size(), samples, surface.color_bytes, sampling.pattern, counters);
}

}  // namespace beampipe
