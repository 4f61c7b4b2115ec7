#include "stages/samples/test_depth.h"

#include "simd/depth_compare.h"
#include "stages/data/pixel_depth.h"
#include "stages/samples/test_depth_cost.h"

namespace beampipe {
namespace {

// The input of the kernels.
std::vector<CellDepth> cell_depths(const SetupTriangles& triangles, const std::vector<SampleFragment>& fragments,
                                   const Tile& tile, const CellGrid& grid) {
  const double cell_width = 1.0 / grid.columns, cell_height = 1.0 / grid.rows;  // pixels; exact
  std::vector<CellDepth> items;
  items.reserve(fragments.size());
  for (const SampleFragment& fragment : fragments) {
    const auto pixel = static_cast<std::int32_t>(tile.index(grid.pixel_x(fragment.x), grid.pixel_y(fragment.y)));
    const CellPlane<float> plane =
        cell_plane(triangles.triangles[fragment.triangle].depth, fragment.x * cell_width, fragment.y * cell_height);
    CellDepth& item = items.emplace_back();
    item.cell = static_cast<std::uint32_t>(pixel * grid.cells_per_pixel() + grid.in_pixel(fragment.x, fragment.y));
    item.mask = fragment.mask;
    item.triangle = fragment.triangle;
    item.z = plane.z, item.dzdx = plane.dzdx, item.dzdy = plane.dzdy;
  }
  return items;
}

void list_accesses(const std::vector<CellDepth>& items, const std::vector<std::uint32_t>& passed,
                   std::vector<SampleAccess>& accesses) {
  accesses.resize(items.size());
  for (std::size_t i = 0; i < items.size(); ++i)
    accesses[i] = {items[i].cell, items[i].triangle, items[i].mask, passed[i]};
}

}  // namespace

void depth_test(const SetupTriangles& triangles, const std::vector<SampleFragment>& fragments, const Tile& tile,
                const Sampling& sampling, StageCounters& counters, SampleTile& surface,
                std::vector<SampleAccess>& accesses) {
  const std::vector<CellDepth> items = cell_depths(triangles, fragments, tile, sampling.grid);
  std::vector<std::uint32_t> masks(items.size());
  const SampleCounts samples = depth_test(items.data(), items.size(), sampling.pattern,
                                          {surface.depth.data(), surface.triangle.data()}, masks.data());
  list_accesses(items, masks, accesses);
  charge_depth_test(items.size(), samples, kSampleDepthBytes + surface.color_bytes, sampling.pattern, counters);
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
  charge_depth_test(items.size(), samples, surface.color_bytes, sampling.pattern, counters);
}

}  // namespace beampipe
