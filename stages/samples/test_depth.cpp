#include "stages/samples/test_depth.h"

#include <algorithm>
#include <array>
#include <bit>

#include "simd/depth_compare.h"
#include "simd/tested_cells.h"
#include "stages/samples/test_depth_cost.h"

namespace beampipe {
namespace {

constexpr std::size_t kBlock = 256;  // fragments; what the kernels read of them stays in the nearest cache

// The input of the kernels that test, block by block: the fragments' cells, and what is read of them.
struct Block {
  std::array<std::int32_t, kBlock + kTestedSlack> x, y;
  std::array<std::uint32_t, kBlock + kTestedSlack> masks;
  std::array<CellPlane<float>, kBlock + kTestedSlack> planes;
};

TileOfCells tile_of_cells(const Tile& tile, const CellGrid& grid) {
  return {tile.x0, tile.y0, tile.width(), std::countr_zero(static_cast<std::uint32_t>(grid.columns)),
          std::countr_zero(static_cast<std::uint32_t>(grid.rows))};
}

// A triangle's cells follow each other.
void set_items(const SampledTriangles& in, const SampleFragment* fragments, std::size_t count, SampleAccess* accesses,
               Block& block) {
  const TileOfCells tile = tile_of_cells(in.tile, in.sampling.grid);
  for (std::size_t first = 0, end = 0; first < count; first = end) {
    const std::uint32_t triangle = fragments[first].triangle;
    for (; end < count && fragments[end].triangle == triangle; ++end)
      block.x[end] = fragments[end].x, block.y[end] = fragments[end].y, block.masks[end] = fragments[end].mask;
    set_tested_cells(tile, in.triangles.triangles[triangle].depth,
                     {triangle, &block.x[first], &block.y[first], &block.masks[first]}, end - first, accesses + first,
                     &block.planes[first]);
  }
}

// Calls test(accesses, planes, count) for one block of fragments after the other.
template <class Test>
SampleCounts test_blocks(const SampledTriangles& in, const std::vector<SampleFragment>& fragments,
                         std::vector<SampleAccess>& accesses, Test&& test) {
  SampleCounts samples{0, 0};
  Block block;
  accesses.resize(fragments.size() + kTestedSlack);
  for (std::size_t first = 0; first < fragments.size(); first += kBlock) {
    const std::size_t count = std::min(kBlock, fragments.size() - first);
    set_items(in, &fragments[first], count, &accesses[first], block);
    const SampleCounts of_block = test(&accesses[first], block.planes.data(), count);
    samples.tested += of_block.tested, samples.passed += of_block.passed;
  }
  accesses.resize(fragments.size());
  return samples;
}

void tell(const std::vector<SampleAccess>& accesses, const Sampling& sampling, const SampleTile& surface) {
  const auto cells = static_cast<std::size_t>(sampling.grid.cells_per_pixel());
  const auto samples = static_cast<std::size_t>(sampling.pattern.count);
  for (const SampleAccess& access : accesses)
    if (PixelObserver* const observer = observer_at(surface.observers, access.cell / cells))
      observer->contends(access.triangle, surface.first_observed + access.cell % cells * samples, access.tested,
                         access.passed);
}

SampleCounts keep_equal(const SampledTriangles& in, const SampleTile& surface, std::vector<SampleFragment>& fragments,
                        std::vector<SampleAccess>& accesses) {
  const SampleCounts samples =
      test_blocks(in, fragments, accesses, [&](SampleAccess* items, const CellPlane<float>* planes, std::size_t count) {
        return depth_equal(items, planes, count, in.sampling.pattern, surface.depth.data());
      });
  for (std::size_t i = 0; i < fragments.size(); ++i) fragments[i].mask = accesses[i].passed;
  std::erase_if(fragments, [](const SampleFragment& fragment) { return fragment.mask == 0; });
  return samples;
}

// Fragments of one follow each other.
std::uint64_t quads_of(const std::vector<SampleFragment>& fragments) {
  std::uint64_t quads = 0;
  for (std::size_t i = 0; i < fragments.size(); ++i) quads += i == 0 || fragments[i].quad != fragments[i - 1].quad;
  return quads;
}

}  // namespace

void depth_test(const SampledTriangles& in, const std::vector<SampleFragment>& fragments, StageCounters& counters,
                SampleTile& surface, std::vector<SampleAccess>& accesses) {
  const SamplePattern& pattern = in.sampling.pattern;
  const SampleCounts samples =
      test_blocks(in, fragments, accesses, [&](SampleAccess* items, const CellPlane<float>* planes, std::size_t count) {
        return depth_test(items, planes, count, pattern, {surface.depth.data(), surface.triangle.data()});
      });
  charge_depth_test(fragments.size(), samples, kSampleDepthBytes + surface.color_bytes, pattern, counters);
  if (surface.observers) tell(accesses, in.sampling, surface);
}

void depth_test_equal(const SampledTriangles& in, StageCounters& counters, const SampleTile& surface,
                      std::vector<SampleFragment>& fragments, std::vector<SampleAccess>& accesses) {
  const std::size_t tested = fragments.size();
  const SampleCounts samples = keep_equal(in, surface, fragments, accesses);
  charge_depth_test(tested, samples, surface.color_bytes, in.sampling.pattern, counters);
}

void depth_test_in_shader(const SampledTriangles& in, StageCounters& counters, const SampleTile& surface,
                          std::vector<SampleFragment>& fragments, std::vector<SampleAccess>& accesses) {
  const std::uint64_t launched = quads_of(fragments);
  const SampleCounts samples = keep_equal(in, surface, fragments, accesses);
  charge_depth_test_in_shader(launched, quads_of(fragments), samples, in.sampling.pattern, counters);
}

}  // namespace beampipe
