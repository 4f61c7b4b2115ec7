// What the stages count for whole batches is what their scalar twins count, item by item, on counting numbers with the
// real data: on every procedural scene.
#include <gtest/gtest.h>

#include "simd/coverage.h"
#include "simd/depth_range.h"
#include "simd/depth_test.h"
#include "simd/mask_table.h"
#include "simd/merge.h"
#include "simd/sample_test.h"
#include "stages/a_buffer.h"
#include "stages/beam_fragment.h"
#include "stages/compose.h"
#include "stages/counting.h"
#include "stages/depth_test.h"
#include "stages/fragment_geometry.h"
#include "stages/merge_sort.h"
#include "stages/shade.h"
#include "stages/vertex_setup.h"
#include "traces/scenes.h"

namespace beampipe {
namespace {

using Int = Counted<std::int64_t>;
using Float = Counted<float>;
using Real = Counted<double>;
using Bits = Counted<std::uint32_t>;

class TwinCounts : public testing::TestWithParam<SceneKind> {
 protected:
  void SetUp() override {
    const std::uint32_t triangles = GetParam().name == "stack" ? 8 : 1500;  // each covers the whole picture
    const Trace trace = make_scene(GetParam().name, {.triangles = triangles, .width = 48, .height = 28});
    StageCounters ignored;
    triangles_ = vertex_setup(trace, trace.frames[0], ignored);
    for (std::uint32_t i = 0; i < triangles_.triangles.size(); ++i) list_.push_back(i);
    ASSERT_FALSE(list_.empty());
  }

  Int integer(std::int64_t value) { return Int(value, twin_); }
  Float real(float value) { return Float(value, twin_); }
  Real real(double value) { return Real(value, twin_); }

  EdgeAt<Int> edge_at(const Edge& edge) { return {integer(edge.a), integer(edge.b), integer(edge.c)}; }

  // What a (pixel, triangle) costs in beam_fragment; `table`, `positions` or `grid`, whichever is not null.
  void count_fragment(const PixelTriangle& pair, const MaskTable* table, const std::vector<SamplePattern>* positions,
                      const PositionGrid* grid = nullptr) {
    const SetupTriangle& triangle = triangles_.triangles[pair.triangle];
    Int x[3], y[3];
    EdgeAt<Int> edges[3];
    for (int k = 0; k < 3; ++k) {
      x[k] = integer(triangle.x[k]), y[k] = integer(triangle.y[k]);
      edges[k] = edge_at(edge_of(triangle, k));
    }
    const Int left = integer(std::int64_t{pair.x} * kSubpixelUnits),
              top = integer(std::int64_t{pair.y} * kSubpixelUnits);
    const PixelTriangleOf<Int> seen = in_pixel(x, y, left, top);
    const ScreenDepth& depth = triangle.depth;
    const Float z = to_float(plane_at(real(depth.z), real(depth.dzdx), real(depth.dzdy), real(depth.anchor_x),
                                      real(depth.anchor_y), real(pair.x + 0.5), real(pair.y + 0.5)));
    coverage_scalar<Int, Float>(seen);
    if (grid) {
      position_mask_scalar(seen, *grid);
    } else {
      DepthRangeInput<Float> in;
      set_geometry(seen, in);
      in.z = z;
      in.dzdu = real(static_cast<float>(depth.dzdx)), in.dzdv = real(static_cast<float>(depth.dzdy));
      for (int k = 0; k < 3; ++k) in.vertex_z[k] = real(triangle.vertex_z[k]);
      depth_range_scalar(in);
    }
    if (table) {
      TableTriangleOf<Counted<std::int32_t>, Bits, Float> lookup;
      for (auto& edge : lookup.edges) {
        edge.angle = Counted<std::int32_t>(pair.x % 32, twin_);
        edge.flip = Bits(pair.y % 2 ? ~0u : 0u, twin_);
        edge.distance = edge_distance(edges[0], left, top, real(1e-3));
      }
      table_mask_scalar(lookup, *table);
    }
    if (positions) {
      Int a[3], b[3], c[3];
      for (int k = 0; k < 3; ++k) {
        a[k] = edges[k].a, b[k] = edges[k].b;
        c[k] = owned_edge(edges[k], left, top, integer(edge_of(triangle, k).owns ? 0 : 1));
      }
      for (const SamplePattern& pattern : *positions) sample_mask_scalar(a, b, c, pattern);
    }
  }

  const Tile tile_{0, 0, 48, 28};
  SetupTriangles triangles_;
  TriangleList list_;
  OperationCounts twin_;  // what the twins have counted
};

TEST_P(TwinCounts, BeamFragmentWithExactMasks) {
  const std::vector<SamplePattern> positions = cell_patterns(256);
  StageCounters raster, counters;
  std::vector<PixelTriangle> pairs;
  conservative_raster(triangles_, list_, tile_, raster, pairs);
  std::vector<Fragment> fragments;
  BeamFragmentOptions options;
  options.mask = MaskSource::exact;
  options.positions = positions;
  beam_fragment(triangles_, pairs, tile_, options, counters, fragments);
  for (const PixelTriangle& pair : pairs) count_fragment(pair, nullptr, &positions);
  EXPECT_EQ(counters.ops, twin_);
}

TEST_P(TwinCounts, BeamFragmentOnAGrid) {  // where full pixels take the short way
  const PositionGrid grid(256);
  StageCounters raster, counters;
  std::vector<PixelTriangle> pairs;
  conservative_raster(triangles_, list_, tile_, raster, pairs);
  std::vector<Fragment> fragments;
  BeamFragmentOptions options;
  options.mask = MaskSource::grid;
  options.grid = &grid;
  options.clipped_depth = false;
  beam_fragment(triangles_, pairs, tile_, options, counters, fragments);
  for (const PixelTriangle& pair : pairs)
    if (!pair.full) count_fragment(pair, nullptr, nullptr, &grid);
  EXPECT_EQ(counters.ops, twin_);
}

TEST_P(TwinCounts, BeamFragmentWithTheTable) {
  const SamplePattern pattern = hammersley_pattern();
  const MaskTable table(pattern);
  StageCounters raster, counters;
  std::vector<PixelTriangle> pairs;
  conservative_raster(triangles_, list_, tile_, raster, pairs);
  std::vector<Fragment> fragments;
  BeamFragmentOptions options;
  options.positions = {pattern};
  options.table = &table;
  beam_fragment(triangles_, pairs, tile_, options, counters, fragments);
  for (const PixelTriangle& pair : pairs) count_fragment(pair, &table, nullptr);
  EXPECT_EQ(counters.ops, twin_);
}

TEST_P(TwinCounts, SortAndMerge) {
  const SamplePattern pattern = hammersley_pattern();
  StageCounters raster, ignored, sorting, composition, over;
  std::vector<PixelTriangle> pairs;
  conservative_raster(triangles_, list_, tile_, raster, pairs);
  std::vector<Fragment> fragments;
  BeamFragmentOptions options;
  options.mask = MaskSource::exact;
  options.positions = {pattern};
  beam_fragment(triangles_, pairs, tile_, options, ignored, fragments);
  shade(std::vector<glm::vec3>(list_.size(), glm::vec3(0.5f)), fragments, ignored);
  const ABuffer buffer = a_buffer(sort_records(fragments, SortKey::centroid), tile_.pixels(), 42, sorting);

  std::vector<std::vector<std::uint32_t>> arrived(tile_.pixels());
  for (std::uint32_t i = 0; i < fragments.size(); ++i) arrived[fragments[i].pixel].push_back(i);
  std::vector<std::uint32_t> scratch;
  for (std::size_t pixel = 0; pixel < tile_.pixels(); ++pixel) {
    merge_sort(arrived[pixel].data(), arrived[pixel].size(), scratch,
               [&](std::uint32_t i) { return real(fragments[i].centroid_z); });
    ASSERT_TRUE(std::equal(arrived[pixel].begin(), arrived[pixel].end(), buffer.records.begin() + buffer.first[pixel]));
  }
  EXPECT_EQ(sorting.ops, twin_);

  const auto count_over = [&] {
    for (const Fragment& fragment : fragments) {
      const MergeFragment in = merge_fragment(fragment);
      const auto counted = [&](float value) { return real(value); };
      const AggregateOf<Float, Bits> surface{counted(in.surface.alpha),
                                             Bits(in.surface.mask, twin_),
                                             {counted(0), counted(0), counted(0)},
                                             counted(0),
                                             counted(0),
                                             counted(0),
                                             {counted(in.surface.color[0]), counted(0), counted(0)}};
      over_scalar(FragmentOf<Float, Bits>{surface, Bits(in.tiny, twin_)}, surface);
    }
  };
  twin_ = {};
  count_over();
  compose_over(fragments, buffer, over);
  EXPECT_EQ(over.ops, twin_);
}

TEST_P(TwinCounts, DepthTest) {
  const Sampling sampling{CellGrid{}, standard_pattern(8)};
  StageCounters raster, counters;
  std::vector<SampleFragment> fragments;
  std::vector<SampleAccess> accesses;
  sample_raster(triangles_, list_, tile_, sampling, raster, fragments);
  SampleTile surface(tile_, sampling), stored(tile_, sampling);
  depth_test(triangles_, fragments, tile_, sampling, counters, surface, accesses);
  for (const SampleFragment& fragment : fragments) {
    const ScreenDepth& plane = triangles_.triangles[fragment.triangle].depth;
    Float z, dzdx, dzdy;
    cell_plane(real(plane.z), real(plane.dzdx), real(plane.dzdy), real(plane.anchor_x), real(plane.anchor_y),
               real(static_cast<double>(fragment.x)), real(static_cast<double>(fragment.y)), z, dzdx, dzdy);
    const auto first = static_cast<std::size_t>(fragment.y * tile_.width() + fragment.x) * 8;
    for (std::size_t s = 0; s < 8; ++s) {
      if (!(fragment.mask >> s & 1)) continue;
      Float depth;
      const bool passes =
          depth_test_scalar(z, dzdx, dzdy, real(static_cast<float>(sampling.pattern.x[s])),
                            real(static_cast<float>(sampling.pattern.y[s])), real(stored.depth[first + s]), depth);
      if (passes) stored.depth[first + s] = depth.value;
    }
  }
  EXPECT_EQ(counters.ops, twin_);
  EXPECT_EQ(surface.depth, stored.depth);
}

INSTANTIATE_TEST_SUITE_P(Scenes, TwinCounts, testing::ValuesIn(scene_kinds()),
                         [](const auto& scene) { return std::string(scene.param.name); });

}  // namespace
}  // namespace beampipe
