#include "stages/depth_test.h"

#include "simd/depth_test.h"
#include "stages/counting.h"
#include "stages/raster_cost.h"

namespace beampipe {

SampleTile::SampleTile(const Tile& tile, const Sampling& sampling)
    : samples_per_pixel(static_cast<std::size_t>(sampling.grid.cells_per_pixel() * sampling.pattern.count)) {
  const std::size_t samples = tile.pixels() * samples_per_pixel + kSampleSlack;
  depth.assign(samples, kFarDepth);
  triangle.assign(samples, kNoTriangle);
}

void depth_test(const SetupTriangles& triangles, const std::vector<SampleFragment>& fragments, const Tile& tile,
                const Sampling& sampling, StageCounters& counters, SampleTile& surface) {
  const CellGrid& grid = sampling.grid;
  std::vector<CellDepth> items;
  items.reserve(fragments.size());
  std::uint64_t tested = 0;
  for (const SampleFragment& fragment : fragments) {
    const ScreenDepth& plane = triangles.triangles[fragment.triangle].depth;
    const std::int32_t pixel_x = fragment.x / grid.columns, pixel_y = fragment.y / grid.rows;
    const std::int32_t pixel = (pixel_y - tile.y0) * tile.width() + pixel_x - tile.x0;
    const std::int32_t cell_in_pixel = (fragment.y % grid.rows) * grid.columns + fragment.x % grid.columns;
    const double left = static_cast<double>(fragment.x) / grid.columns,
                 top = static_cast<double>(fragment.y) / grid.rows;
    items.push_back({static_cast<std::uint32_t>(pixel * grid.cells_per_pixel() + cell_in_pixel), fragment.mask,
                     fragment.triangle, static_cast<float>(plane.at(left, top)),
                     static_cast<float>(plane.dzdx / kSubpixelUnits), static_cast<float>(plane.dzdy / kSubpixelUnits)});
    tested += static_cast<std::uint64_t>(std::popcount(fragment.mask));
  }
  const std::uint64_t passed =
      depth_test(items.data(), items.size(), sampling.pattern, {surface.depth.data(), surface.triangle.data()});

  const OperationCounts per_sample = count_operations([](OperationCounts& counts) {
    const Counted<float> one(1.0f, counts);
    Counted<float> depth;
    depth_test_scalar(one, one, one, one, one, one, depth);
  });
  counters.items_in += tested;
  counters.items_out += passed;
  counters.ops += per_sample * tested;
  counters.bytes_read += tested * kSampleDepthBytes + fragments.size() * kSampleFragmentBytes;
  counters.bytes_written += passed * (kSampleDepthBytes + kSampleColorBytes);
  counters.lanes_used += tested;
  counters.lanes_issued += fragments.size() * static_cast<std::size_t>(sampling.pattern.count);
}

}  // namespace beampipe
