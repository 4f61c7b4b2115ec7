#include "stages/raster/sample_raster.h"

#include <gtest/gtest.h>

#include <bit>
#include <map>
#include <set>
#include <tuple>
#include <vector>

#include "tests/stages/screen_triangles.h"

namespace beampipe {
namespace {

constexpr Tile kFrame{0, 0, 8, 8};

std::vector<Sampling> every_sampling() {
  std::vector<Sampling> all;
  for (const int count : {1, 2, 4, 8, 16}) all.push_back({CellGrid{}, standard_pattern(count)});
  for (const CellGrid grid : {CellGrid{2, 2}, CellGrid{4, 2}, CellGrid{16, 8}})  // super-resolution
    all.push_back({grid, standard_pattern(8, grid.cell_width(), grid.cell_height())});
  return all;
}

std::string name_of(const Sampling& sampling) {
  return std::to_string(sampling.grid.columns) + " x " + std::to_string(sampling.grid.rows) + " cells of " +
         std::to_string(sampling.pattern.count) + " samples";
}

struct Raster {
  std::vector<SampleFragment> fragments;
  StageCounters counters;
};

Raster rasterize(const SetupTriangles& triangles, const Tile& tile, const Sampling& sampling) {
  Raster raster;
  sample_raster({triangles, tile, sampling}, all_of(triangles), raster.counters, raster.fragments);
  return raster;
}

// The number of triangles that cover each sample of the frame.
std::vector<int> hits(const SetupTriangles& triangles, const Sampling& sampling) {
  const int columns = kFrame.x1 * sampling.grid.columns, rows = kFrame.y1 * sampling.grid.rows;
  const int count = sampling.pattern.count;
  std::vector<int> per_sample(static_cast<std::size_t>(columns * rows * count));
  for (const SampleFragment& f : rasterize(triangles, kFrame, sampling).fragments)
    for (int s = 0; s < count; ++s)
      per_sample[static_cast<std::size_t>((f.y * columns + f.x) * count + s)] += static_cast<int>(f.mask >> s & 1);
  return per_sample;
}

void expect_each_sample_once(const SetupTriangles& triangles) {
  for (const Sampling& sampling : every_sampling()) {
    const std::vector<int> found = hits(triangles, sampling);
    EXPECT_EQ(found, std::vector<int>(found.size(), 1)) << name_of(sampling);
  }
}

TEST(SampleRaster, EdgesAtThousandsOfAnglesLeaveNoSampleOutAndTakeNoneTwice) {
  Random random(111);
  SCOPED_TRACE(random.name());
  for (int round = 0; round < 3; ++round) {
    const ScreenPoint hub{random.int32(0, 8 * 256), random.int32(0, 8 * 256)};
    expect_each_sample_once(fan_around(hub, 6'000, 500, &random));
  }
}

TEST(SampleRaster, GiantsLeaveNoSampleOutAndTakeNoneTwice) {
  Random random(112);
  SCOPED_TRACE(random.name());
  expect_each_sample_once(fan_around({1'000, 1'100}, (1 << 23) - 2'000, 500, &random));
}

// The hub lies on a sample, which is therefore on the edges of all triangles of the fan. Some edges pass through more
// samples.
TEST(SampleRaster, FansAroundASample) {
  Random random(113);
  SCOPED_TRACE(random.name());
  for (const Sampling& sampling : every_sampling()) {
    for (std::size_t s = 0; s < static_cast<std::size_t>(sampling.pattern.count); ++s) {
      const ScreenPoint hub{3 * 256 + sampling.pattern.x[s], 4 * 256 + sampling.pattern.y[s]};
      for (const std::int32_t per_side : {1, 2, 3, 8, 64}) {
        for (const auto& fan : {fan_around(hub, 4'096, per_side), fan_around(hub, 4'096, per_side, &random)}) {
          const std::vector<int> found = hits(fan, sampling);
          ASSERT_EQ(found, std::vector<int>(found.size(), 1)) << name_of(sampling) << ", sample " << s;
        }
      }
    }
  }
}

// A sample on an edge counts as if it lay a little further to the right, and even less further down. Then no sample
// lies on any edge.
bool covers(const SetupTriangle& t, std::int64_t x, std::int64_t y) {
  for (int k = 0; k < 3; ++k) {
    const std::int64_t px = t.x[k], py = t.y[k], qx = t.x[(k + 1) % 3], qy = t.y[(k + 1) % 3];
    const std::int64_t value = (qx - px) * (y - py) - (x - px) * (qy - py);
    if (std::tuple(value, py - qy, qx - px) < std::tuple(0, 0, 0)) return false;
  }
  return true;
}

TEST(SampleRaster, EqualsATestOfEverySample) {
  Random random(114);
  SCOPED_TRACE(random.name());
  for (const Sampling& sampling : every_sampling()) {
    const CellGrid& grid = sampling.grid;
    const SetupTriangles triangles = random_triangles(random, 3'000 / grid.cells_per_pixel());
    std::map<std::tuple<std::uint32_t, int, int>, std::uint32_t> expected, found;
    for (std::uint32_t i = 0; i < triangles.triangles.size(); ++i)
      for (int y = 0; y < kFrame.y1 * grid.rows; ++y)
        for (int x = 0; x < kFrame.x1 * grid.columns; ++x) {
          std::uint32_t mask = 0;
          for (std::size_t s = 0; s < static_cast<std::size_t>(sampling.pattern.count); ++s)
            mask |=
                static_cast<std::uint32_t>(covers(triangles.triangles[i], x * grid.cell_width() + sampling.pattern.x[s],
                                                  y * grid.cell_height() + sampling.pattern.y[s]))
                << s;
          if (mask) expected[{i, x, y}] = mask;
        }
    const Raster raster = rasterize(triangles, kFrame, sampling);
    for (const SampleFragment& f : raster.fragments) found[{f.triangle, f.x, f.y}] = f.mask;
    EXPECT_EQ(found.size(), raster.fragments.size()) << "a cell occurs twice";
    EXPECT_TRUE(found == expected) << name_of(sampling);
    EXPECT_EQ(raster.counters.items_out, expected.size());
  }
}

TEST(SampleRaster, TilesTogetherGiveWhatOneTileGives) {
  Random random(115);
  SCOPED_TRACE(random.name());
  const SetupTriangles triangles = random_triangles(random, 500);
  const auto key = [](const SampleFragment& f) { return std::tuple(f.triangle, f.x, f.y, f.mask); };
  for (const Sampling& sampling : every_sampling()) {
    const Raster whole = rasterize(triangles, kFrame, sampling);
    StageCounters counters;
    std::set<std::tuple<std::uint32_t, std::int32_t, std::int32_t, std::uint32_t>> expected, found;
    for (const SampleFragment& f : whole.fragments) expected.insert(key(f));
    for (std::int32_t y = 0; y < kFrame.y1; y += 2)
      for (std::int32_t x = 0; x < kFrame.x1; x += 4) {
        const Raster tile = rasterize(triangles, {x, y, x + 4, y + 2}, sampling);
        for (const SampleFragment& f : tile.fragments) found.insert(key(f));
        counters += tile.counters;
      }
    EXPECT_TRUE(found == expected) << name_of(sampling);
    counters.ops = whole.counters.ops;  // bounds and first edge values are computed in every tile
    EXPECT_TRUE(counters == whole.counters) << name_of(sampling);
  }
}

TEST(SampleRaster, QuadNumbersNameQuads) {
  Random random(116);
  SCOPED_TRACE(random.name());
  const SetupTriangles triangles = random_triangles(random, 1'000);
  std::map<std::uint32_t, std::tuple<std::uint32_t, std::int32_t, std::int32_t>> quads;
  std::set<std::tuple<std::uint32_t, std::int32_t, std::int32_t>> distinct;
  for (const SampleFragment& f : rasterize(triangles, kFrame, every_sampling()[2]).fragments) {
    const std::tuple where(f.triangle, f.x >> 1, f.y >> 1);
    EXPECT_EQ(quads.try_emplace(f.quad, where).first->second, where);
    distinct.insert(where);
  }
  EXPECT_EQ(distinct.size(), quads.size());
}

// Counted by hand. One triangle in one pixel covers the first of the four samples at (96, 32), (224, 96), (32, 160) and
// (160, 224). Bounds and edges cost as much as in ConservativeRaster.CountsCellsAndOperations, plus a sum per edge for
// the top-left rule. For the one cell, per edge: twice a sum and a comparison, the top-left rule and, per sample, 2
// products, 2 sums and a comparison.
TEST(SampleRaster, CountsSamplesAndOperations) {
  SetupTriangles triangles;
  add_triangle(triangles, {80, 20}, {120, 30}, {90, 60});
  const Raster raster = rasterize(triangles, kFrame, {CellGrid{}, standard_pattern(4)});
  ASSERT_EQ(raster.fragments.size(), 1u);
  EXPECT_EQ(raster.fragments[0].mask, 0b0001u);
  EXPECT_EQ(raster.counters.lanes_used, 1u);
  EXPECT_EQ(raster.counters.lanes_issued, 4u);
  EXPECT_EQ(raster.counters.ops,
            (OperationCounts{2 + 3 * 6 + 4 * 3 * 2, 16 + 3 * 13 + 3 * 4 + 3 + 4 * 3 * 3, 4, 0, 0, 0}));
  EXPECT_EQ(raster.counters.bytes_written, 10u);
}

}  // namespace
}  // namespace beampipe
