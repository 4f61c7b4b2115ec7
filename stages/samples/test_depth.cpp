#include "stages/samples/test_depth.h"

#include <algorithm>
#include <array>

#include "simd/depth_compare.h"
#include "stages/data/pixel_depth.h"
#include "stages/samples/test_depth_cost.h"

namespace beampipe {
namespace {

constexpr std::size_t kBlock = 256;  // fragments; what the kernels read of them stays in the nearest cache

// The input of a kernel. A triangle's cells follow each other, and its slopes are the same in all of them.
void set_items(const SampledTriangles& in, const SampleFragment* fragments, std::size_t count, SampleAccess* accesses,
               CellPlane<float>* planes) {
  const CellGrid grid = in.sampling.grid;
  const Tile tile = in.tile;
  const double cell_width = 1.0 / grid.columns, cell_height = 1.0 / grid.rows;  // pixels; exact
  for (std::size_t first = 0, end = 0; first < count; first = end) {
    const std::uint32_t triangle = fragments[first].triangle;
    const ScreenDepth depth = in.triangles.triangles[triangle].depth;
    CellPlane<float> plane = cell_plane(depth, 0.0, 0.0);
    for (; end < count && fragments[end].triangle == triangle; ++end) {
      const SampleFragment& fragment = fragments[end];
      plane.z = cell_depth(depth, fragment.x * cell_width, fragment.y * cell_height);
      planes[end] = plane;
      accesses[end] = {cell_number(fragment, tile, grid), triangle, fragment.mask, 0};
    }
  }
}

// Calls test(accesses, planes, count) for one block of fragments after the other.
template <class Test>
SampleCounts test_blocks(const SampledTriangles& in, const std::vector<SampleFragment>& fragments,
                         std::vector<SampleAccess>& accesses, Test&& test) {
  SampleCounts samples{0, 0};
  std::array<CellPlane<float>, kBlock> planes;
  accesses.resize(fragments.size());
  for (std::size_t first = 0; first < fragments.size(); first += kBlock) {
    const std::size_t count = std::min(kBlock, fragments.size() - first);
    set_items(in, &fragments[first], count, &accesses[first], planes.data());
    const SampleCounts of_block = test(&accesses[first], planes.data(), count);
    samples.tested += of_block.tested, samples.passed += of_block.passed;
  }
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
