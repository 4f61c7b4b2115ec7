// The time of kernels per item, on one core with its best instruction set. Each item is a pixel with a random
// triangle around it, up to three pixels wide, as in fine meshes. limit_ns: what the operations of a kernel's formula
// take in full vectors of 32-bit numbers; those of 64 bits take twice as long.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <random>
#include <vector>

#include "bench/vector_peak.h"
#include "simd/coverage.h"
#include "simd/depth_range.h"
#include "simd/depth_span.h"
#include "simd/mask_table.h"
#include "simd/merge.h"
#include "simd/plane_order.h"
#include "simd/position_mask.h"
#include "simd/quad_rows.h"
#include "simd/vertex_transform.h"
#include "simd/window_owners.h"
#include "stages/beam/casav_merges.h"
#include "stages/cost/plane_cost.h"
#include "stages/raster/traverse_cost.h"

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

// The most of several runs.
double operations_per_ns() {
  static const double most = [] {
    using Clock = std::chrono::steady_clock;
    double found = 0;
    float result = 0;
    for (int i = 0; i < 1000; ++i) {
      const Clock::time_point start = Clock::now();
      const std::uint64_t operations = run_vector_operations(result);
      const std::chrono::duration<double, std::nano> time = Clock::now() - start;
      found = std::max(found, static_cast<double>(operations) / time.count());
    }
    benchmark::DoNotOptimize(result);
    return found;
  }();
  return most;
}

void vector_peak(benchmark::State& state) {
  float result = 0;
  for (auto _ : state) benchmark::DoNotOptimize(run_vector_operations(result));
  state.counters["operations_per_ns"] = operations_per_ns();
}
BENCHMARK(vector_peak);

// `of_items`: the operations of so many items.
void set_limit(benchmark::State& state, const OperationCounts& of_items, std::size_t items = 1) {
  state.counters["limit_ns"] = static_cast<double>(of_items.total()) / static_cast<double>(items) / operations_per_ns();
}

void coverage_of_pixels(benchmark::State& state) {
  const std::vector<TriangleInPixel> in = triangles_in_pixels();
  std::vector<Coverage<float>> out(in.size());
  for (auto _ : state) {
    coverage(in.data(), in.size(), out.data());
    benchmark::DoNotOptimize(out.data());
  }
  count_items(state, in.size());
  set_limit(state, count_operations([](OperationCounts& counts) {
              const Counted<std::int32_t> one(1, counts);
              coverage_formula<Counted<std::int32_t>, Counted<float>>({{one, one, one}, {one, one, one}});
            }));
}
BENCHMARK(coverage_of_pixels);

// A number from `low` to `high`.
float random_real(std::mt19937& random, float low, float high) {
  return low + (high - low) * (static_cast<float>(random()) * 0x1p-32f);
}

DepthPlane<float> random_plane(std::mt19937& random) {
  return {random_real(random, -1, 0), random_real(random, -0.05f, 0.05f), random_real(random, -0.05f, 0.05f)};
}

void depth_ranges_of_pixels(benchmark::State& state) {
  std::mt19937 random(3);
  std::vector<DepthRangeInput<float>> in;
  for (const TriangleInPixel& t : triangles_in_pixels()) {
    const DepthPlane<float> plane = random_plane(random);
    DepthRangeInput<float> input;
    for (int k = 0; k < 3; ++k) {
      const EdgeInPixel<std::int32_t> edge = edge_in_pixel(t, k);
      input.u[k] = static_cast<float>(t.x[k]) / kSubpixelUnits,
      input.v[k] = static_cast<float>(t.y[k]) / kSubpixelUnits;
      for (int i = 0; i < 4; ++i)
        input.corner[k][i] =
            static_cast<float>(edge.a * kSubpixelUnits * (i & 1) + edge.b * kSubpixelUnits * (i >> 1) + edge.c) / 65536;
      input.vertex_z[k] = plane.z + plane.dzdu * (input.u[k] - 0.5f) + plane.dzdv * (input.v[k] - 0.5f);
    }
    input.z = plane.z, input.dzdu = plane.dzdu, input.dzdv = plane.dzdv;
    in.push_back(input);
  }
  std::vector<DepthRange<float>> out(in.size());
  for (auto _ : state) {
    depth_range(in.data(), in.size(), out.data());
    benchmark::DoNotOptimize(out.data());
  }
  count_items(state, in.size());
  set_limit(state, count_operations([](OperationCounts& counts) {
              DepthRangeInput<Counted<float>> input;
              const Counted<float> one(1.0f, counts);
              std::fill_n(&input.u[0], sizeof input / sizeof one, one);
              depth_range_formula(input);
            }));
}
BENCHMARK(depth_ranges_of_pixels);

void masks_by_table(benchmark::State& state) {
  const MaskTable table(hammersley_pattern());
  std::mt19937 random(4);
  std::vector<TableTriangle> in(kItems);
  for (TableTriangle& triangle : in)
    for (TableEdge& edge : triangle.edges)
      edge = {static_cast<std::int32_t>(random() % 32), random() % 2 ? ~0u : 0u, random_real(random, -1, 1)};
  std::vector<std::uint32_t> out(in.size());
  for (auto _ : state) {
    table_masks(in.data(), in.size(), table, out.data());
    benchmark::DoNotOptimize(out.data());
  }
  count_items(state, in.size());
  set_limit(
      state, count_operations([&](OperationCounts& counts) {
        TableTriangleOf<Counted<std::int32_t>, Counted<std::uint32_t>, Counted<float>> triangle;
        for (auto& edge : triangle.edges)
          edge = {Counted<std::int32_t>(0, counts), Counted<std::uint32_t>(0u, counts), Counted<float>(0, counts)};
        table_mask_formula(triangle, table);
      }));
}
BENCHMARK(masks_by_table);

// With the default rules, and with those that do the most work.
void merges_of_fragments(benchmark::State& state) {
  using R = MergeRules;
  const MergePositions positions(hammersley_pattern());
  MergeRules rules;
  if (state.range(0) != 0)
    rules = {R::Overlap::transition, R::Regional::local, R::Fuzzy::mix,           R::Extents::range,
             R::Slab::visible,       R::Plane::visible,  R::Thickness::containing};
  std::mt19937 random(5);
  std::vector<MergeFragment> fragments(kItems);
  for (MergeFragment& fragment : fragments) {
    const DepthPlane<float> plane = random_plane(random);
    const auto mask = static_cast<std::uint32_t>(random());
    fragment = {{.alpha = random_real(random, 0, 1),
                 .mask = mask,
                 .plane = plane,
                 .thickness = 0,
                 .z_min = plane.z - 0.05f,
                 .z_max = plane.z + 0.05f,
                 .color = {0.1f, 0.2f, 0.3f}},
                0u,
                0u};
  }
  std::vector<Aggregate> aggregates;
  std::vector<MergeSteps> steps(fragments.size());
  for (const MergeFragment& fragment : fragments) aggregates.push_back(fragment.surface);
  for (auto _ : state) {
    std::rotate(fragments.begin(), fragments.begin() + 1, fragments.end());
    merge(fragments.data(), fragments.size(), positions, rules, aggregates.data(), steps.data());
    benchmark::DoNotOptimize(aggregates.data());
  }
  count_items(state, fragments.size());
  MergeWork work;
  for (const MergeSteps& each : steps) work.add(each);
  OperationCounts cost = casav_merges_cost(work, rules, CasavStorage::slides);
  cost.convert -= 2 * packed_numbers(CasavStorage::slides) * work.merges;  // these aggregates are not packed
  set_limit(state, cost, fragments.size());
}
BENCHMARK(merges_of_fragments)->Arg(0)->Arg(1);

void transforms_of_vertices(benchmark::State& state) {
  VertexTransform transform{{}, 1280, 720};
  transform.to_clip[0] = transform.to_clip[5] = 1.5;
  transform.to_clip[10] = transform.to_clip[11] = -1, transform.to_clip[14] = -0.1;
  std::mt19937 random(6);
  std::vector<float> positions(3 * kItems);
  for (float& value : positions) value = random_real(random, -4, 2);
  std::vector<ProjectedVertex> out(kItems);
  for (auto _ : state) {
    benchmark::DoNotOptimize(transform_vertices(positions.data(), kItems, transform, out.data()));
    benchmark::DoNotOptimize(out.data());
  }
  count_items(state, kItems);
  set_limit(state, count_operations([](OperationCounts& counts) {
              const Counted<double> one(1.0, counts);
              std::array<Counted<double>, 16> matrix;
              matrix.fill(one);
              const ClipVertex<Counted<double>> clip = transform_vertex(matrix, one, one, one);
              static_cast<void>(in_view(clip));
              const ScreenVertex<Counted<double>> screen = project(clip, one, one);
              to_grid(screen.x), to_grid(screen.y);
            }));
}
BENCHMARK(transforms_of_vertices);

void orders_of_planes(benchmark::State& state) {
  const std::vector<PositionOffsets> offsets = offsets_of(cell_patterns(256));
  std::mt19937 random(7);
  std::vector<DepthPlane<float>> planes(kItems);
  for (DepthPlane<float>& plane : planes) plane = random_plane(random);
  std::uint32_t masks[kMaxMaskWords] = {};
  float farthest = 0;
  for (auto _ : state) {
    for (std::size_t i = 1; i < planes.size(); ++i) {
      nearer_positions(planes[i], planes[i - 1], offsets.data(), offsets.size(), masks);
      farthest += farthest_depth(planes[i], offsets.data(), offsets.size(), masks);
    }
    benchmark::DoNotOptimize(farthest);
  }
  count_items(state, planes.size() - 1);
  OperationCounts of_position = nearer_cost();
  of_position += count_operations([](OperationCounts& counts) {
    const Counted<float> one(1.0f, counts);
    farthest_formula(DepthPlane<Counted<float>>{one, one, one}, one, one, one > one, one);
  });
  set_limit(state, of_position * 256);
}
BENCHMARK(orders_of_planes);

void depths_of_spans(benchmark::State& state) {
  const auto count = static_cast<std::size_t>(state.range(0));
  std::mt19937 random(8);
  std::vector<double> depth(count);
  for (double& z : depth) z = random_real(random, -1, 0);
  std::vector<std::uint64_t> owner(count);
  const DepthSpan span{-0.5, 1e-3, 0, 0, 1.0 / 64};
  for (auto _ : state) {
    benchmark::DoNotOptimize(depth_span(span, count, 9, depth.data(), owner.data()));
    benchmark::DoNotOptimize(depth.data());
  }
  count_items(state, count);
  set_limit(state, count_operations([](OperationCounts& counts) {
              const Counted<double> one(1.0, counts);
              Counted<double> found;
              depth_span_sample(DepthSpanOf<Counted<double>>{one, one, one, one, one}, one, one, found);
            }));
}
BENCHMARK(depths_of_spans)->Arg(16)->Arg(250);

void masks_of_pixels(benchmark::State& state) {
  const std::vector<TriangleInPixel> in = triangles_in_pixels();
  const PositionGrid grid(static_cast<int>(state.range(0)));
  std::vector<WideMask> out(in.size());
  EdgesTested tested;
  for (auto _ : state) {
    tested = position_masks(in.data(), in.size(), grid, out.data());
    benchmark::DoNotOptimize(out.data());
  }
  count_items(state, in.size());
  const auto cut = [&](auto&& edge_of) {
    return count_operations([&](OperationCounts& counts) {
      const Counted<std::int64_t> one(1, counts);
      Counted<std::uint32_t> words[kMaxMaskWords];
      cut_mask(edge_of(EdgeInPixel<Counted<std::int64_t>>{one, one, one}), grid, words);
    });
  };
  OperationCounts of_edges = cut([](const auto& edge) { return narrowed(edge); }) * tested.narrow;
  of_edges += cut([](const auto& edge) { return edge; }) * tested.wide;
  set_limit(state, of_edges, in.size());
}
BENCHMARK(masks_of_pixels)->Arg(32)->Arg(128)->Arg(256);

void rows_of_quads(benchmark::State& state) {
  const auto quads = static_cast<std::size_t>(state.range(0));
  QuadRow rows[4];
  EdgeOverCells edges[3] = {{-4096, 512, -100, 512, -612}, {60'000, -300, 200, 200, -300}, {9'000, 77, 223, 300, 0}};
  for (auto _ : state) {
    edges[0].start -= 1;
    quad_rows(edges, quads, std::size(rows), rows);
    benchmark::DoNotOptimize(rows);
  }
  count_items(state, 1);
  OperationCounts of_cell = step_cost();
  of_cell += cell_test_cost();
  constexpr std::size_t kCellsPerQuad = 4;
  set_limit(state, of_cell * (kCellsPerQuad * quads * std::size(rows)));
}
BENCHMARK(rows_of_quads)->Arg(1)->Arg(4)->Arg(16);

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
  std::uint64_t tests = 0;
  for (auto _ : state) {
    tests = 0;
    for (std::size_t first = 0; first < fragments.size(); first += count)
      tests += window_owners(fragments.data() + first, count, {}, patterns.data(), owners.data()).tests;
    benchmark::DoNotOptimize(owners.data());
  }
  count_items(state, fragments.size());
  set_limit(state, depth_test_cost() * tests, fragments.size());  // of depth tests alone
}
BENCHMARK(owners_of_windows)->Arg(1)->Arg(2)->Arg(4)->Arg(16);

}  // namespace
}  // namespace beampipe
