#include "stages/raster/sample_raster.h"

#include "tests/stages/screen_triangles.h"

namespace beampipe::sample_raster_test {

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

TEST(SampleRaster, EqualsATestOfEverySample) {
  Random random(114);
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

// The fragments of a triangle come one 2x2 quad of cells after the other, and those of one quad have a number of their
// own.
TEST(SampleRaster, QuadsFollowEachOtherAndHaveNumbers) {
  Random random(115);
  const Tile wide{0, 0, 100, 60};
  for (const Sampling& sampling : every_sampling()) {
    const SetupTriangles triangles = random_triangles(random, 2'000 / sampling.grid.cells_per_pixel());
    const auto place = [](const SampleFragment& f) {
      return std::tuple(f.triangle, f.y >> 1, f.x >> 1, f.y & 1, f.x & 1);
    };
    const auto quad = [](const SampleFragment& f) { return std::tuple(f.triangle, f.y >> 1, f.x >> 1); };
    const std::vector<SampleFragment> fragments = rasterize(triangles, wide, sampling).fragments;
    for (std::size_t i = 1; i < fragments.size(); ++i) {
      const SampleFragment &before = fragments[i - 1], &here = fragments[i];
      ASSERT_LT(place(before), place(here)) << name_of(sampling) << ", fragment " << i;
      ASSERT_EQ(quad(before) == quad(here), before.quad == here.quad) << name_of(sampling) << ", fragment " << i;
    }
  }
}

}  // namespace beampipe::sample_raster_test
