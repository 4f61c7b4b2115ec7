// The time of kernels per item, on one core with its best instruction set. Each item is a pixel with a random
// triangle around it, up to three pixels wide, as in fine meshes.
#include <benchmark/benchmark.h>

#include <random>
#include <vector>

#include "simd/cell_rows.h"
#include "simd/coverage.h"
#include "simd/position_mask.h"
#include "simd/window_owners.h"

namespace beampipe {
namespace {

constexpr std::size_t kItems = 4096;

std::vector<TriangleInPixel> triangles_in_pixels() {
  std::mt19937 random(1);
  std::uniform_int_distribution<std::int32_t> coordinate(-256, 511);
  std::vector<TriangleInPixel> triangles;
  while (triangles.size() < kItems) {
    TriangleInPixel t;
    for (int k = 0; k < 3; ++k) t.x[k] = coordinate(random), t.y[k] = coordinate(random);
    const std::int32_t area2 = (t.x[1] - t.x[0]) * (t.y[2] - t.y[0]) - (t.x[2] - t.x[0]) * (t.y[1] - t.y[0]);
    if (area2 > 0) triangles.push_back(t);
  }
  return triangles;
}

void count_items(benchmark::State& state, std::size_t items) {
  state.SetItemsProcessed(static_cast<std::int64_t>(items) * state.iterations());
  state.counters["ns_per_item"] = benchmark::Counter(
      static_cast<double>(items) * 1e-9, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void coverage_of_pixels(benchmark::State& state) {
  const std::vector<TriangleInPixel> in = triangles_in_pixels();
  std::vector<Coverage<float>> out(in.size());
  for (auto _ : state) {
    coverage(in.data(), in.size(), out.data());
    benchmark::DoNotOptimize(out.data());
  }
  count_items(state, in.size());
}
BENCHMARK(coverage_of_pixels);

void masks_of_pixels(benchmark::State& state) {
  const std::vector<TriangleInPixel> in = triangles_in_pixels();
  const PositionGrid grid(static_cast<int>(state.range(0)));
  std::vector<WideMask> out(in.size());
  for (auto _ : state) {
    position_masks(in.data(), in.size(), grid, out.data());
    benchmark::DoNotOptimize(out.data());
  }
  count_items(state, in.size());
}
BENCHMARK(masks_of_pixels)->Arg(32)->Arg(128)->Arg(256);

void rows_of_cells(benchmark::State& state) {
  const auto cells = static_cast<std::size_t>(state.range(0));
  EdgeOverCells edges[3] = {{-4096, 512, 512, -512}, {60'000, -300, 200, -300}, {9'000, 77, 300, 0}};
  for (auto _ : state) {
    edges[0].start -= 1;
    benchmark::DoNotOptimize(cell_row(edges, cells));
  }
  count_items(state, 1);
}
BENCHMARK(rows_of_cells)->Arg(2)->Arg(8)->Arg(32);

// Windows of a given number of fragments, whose random masks cover half of the positions.
void owners_of_windows(benchmark::State& state) {
  const auto count = static_cast<std::size_t>(state.range(0));
  std::mt19937 random(2);
  std::vector<MaskedPlane> fragments(kItems / count * count);
  for (MaskedPlane& fragment : fragments) {
    for (std::uint32_t& word : fragment.mask.words) word = static_cast<std::uint32_t>(random());
    fragment.plane = corner_plane({-0.5f + 1e-10f * static_cast<float>(random()), 1e-3f, -1e-3f});
  }
  const std::vector<SamplePattern> patterns = cell_patterns(256);
  std::vector<Ownership> owners(count);
  for (auto _ : state) {
    for (std::size_t first = 0; first < fragments.size(); first += count)
      window_owners(fragments.data() + first, count, {}, patterns.data(), owners.data());
    benchmark::DoNotOptimize(owners.data());
  }
  count_items(state, fragments.size());
}
BENCHMARK(owners_of_windows)->Arg(1)->Arg(2)->Arg(4)->Arg(16);

}  // namespace
}  // namespace beampipe
