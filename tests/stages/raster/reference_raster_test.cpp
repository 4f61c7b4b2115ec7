#include "stages/raster/reference_raster.h"

#include "tests/stages/screen_triangles.h"

namespace beampipe::reference_raster_test {

// Finds the owners by testing every triangle at every sample, from the first to the last. A pixel has 256 rows of 16
// samples. Those of row r are shifted to the right by (reverse(r) + 1/2) / 256 of the distance between samples;
// reverse() reverses 8 bits. Units: 1/8192 px.
std::vector<std::uint64_t> brute_force(const SetupTriangles& triangles, const Tile& tile) {
  std::vector<std::uint64_t> owners;
  for (std::int64_t row = tile.y0 * 256; row < tile.y1 * 256; ++row) {
    std::int64_t reversed = 0;
    for (int bit = 0; bit < 8; ++bit) reversed = 2 * reversed + (row >> bit) % 2;
    for (std::int64_t column = tile.x0 * 16; column < tile.x1 * 16; ++column) {
      const std::int64_t x = 512 * column + 2 * reversed + 1, y = 32 * row + 16;
      double nearest = std::numeric_limits<double>::infinity();
      std::uint64_t owner = kNoOwner;
      for (std::size_t i = 0; i < triangles.triangles.size(); ++i) {
        const SetupTriangle& t = triangles.triangles[i];
        bool inside = true;
        for (int k = 0; k < 3; ++k) {
          const std::int64_t px = t.x[k], py = t.y[k], qx = t.x[(k + 1) % 3], qy = t.y[(k + 1) % 3];
          const std::int64_t value = (qx - px) * (y - 32 * py) - (x - 32 * px) * (qy - py);
          inside &= std::tuple(value, py - qy, qx - px) >= std::tuple(0, 0, 0);  // ties: right, then down
        }
        const double depth = t.depth.at(static_cast<double>(x) / 8192, static_cast<double>(y) / 8192);
        if (!inside || !(depth < nearest)) continue;
        nearest = depth;
        owner = i;
      }
      owners.push_back(owner);
    }
  }
  return owners;
}

TEST(ReferenceRaster, EqualsATestOfEverySample) {
  Random random(121);
  for (int round = 0; round < 12; ++round) {
    SetupTriangles triangles = random_triangles(random, 12);
    for (int i = 0; i < 12; ++i) {  // two triangles whose common edge, of slope 16, runs through samples
      const std::int32_t x = random.int32(0, 2'000), y = random.int32(-200, 200), length = random.int32(8, 100) * 2 + 1;
      const ScreenPoint from{x, y, -0.9f}, to{x + length, y + 16 * length, -0.9f};
      add_triangle(triangles, from, to,
                   {x - 3'000, y + 100, random.real32(-1, 0)});  // comes first, but does not own the edge
      add_triangle(triangles, from, to, {x + 3'000, y - 100, random.real32(-1, 0)});
    }
    triangles.triangles.push_back(triangles.triangles.front());  // the same depths again must not win
    const Tile tile = round % 2 == 0 ? Tile{0, 0, 4, 4} : Tile{6, 2, 9, 5};
    ReferenceTile surface(tile);
    StageCounters counters;
    reference_raster(triangles, all_of(triangles), tile, counters, surface);
    EXPECT_TRUE(surface.owner == brute_force(triangles, tile)) << "round " << round;
  }
}

TEST(ReferenceRaster, FansCoverEverySample) {
  const Tile tile{0, 0, 4, 4};
  const SetupTriangles fan = fan_around({514, 514}, 4'096, 400);  // some of its edges have slope 16 and the like
  ReferenceTile surface(tile);
  StageCounters counters;
  reference_raster(fan, all_of(fan), tile, counters, surface);
  EXPECT_EQ(std::count(surface.owner.begin(), surface.owner.end(), kNoOwner), 0);
  EXPECT_EQ(counters.lanes_used, tile.pixels() * 4096);  // each sample is in one span
  EXPECT_EQ(counters.lanes_issued, counters.lanes_used);
  EXPECT_EQ(counters.items_out, counters.lanes_used);
  // Per sample, 2 products and 3 sums for the depth, and one comparison. Finding the spans is not charged.
  EXPECT_EQ(counters.ops, (OperationCounts{.mul_add = 2, .add = 4} * counters.lanes_used));
}

TEST(ReferenceRaster, ResolveIsTheMeanOfTheSamples) {
  const Tile tile{0, 0, 2, 1};
  ReferenceTile surface(tile);
  // The upper half of the left pixel belongs to triangle 0, a quarter of it to 1; the right one is empty.
  for (std::size_t row = 0; row < 256; ++row)
    for (std::size_t i = 0; i < 16; ++i)
      if (row < 128 || i < 8) surface.owner[row * surface.row_samples + i] = row < 128 ? 0 : 1;
  StageCounters counters;
  const auto image = resolve(surface, tile, std::vector<glm::vec3>{{1, 0, 0}, {0, 1, 0}}, {0, 0, 0.5f}, counters);
  ASSERT_EQ(image.size(), 2u);
  EXPECT_EQ(image[0], glm::vec4(0.5f, 0.25f, 0.125f, 0.75f));
  EXPECT_EQ(image[1], glm::vec4(0, 0, 0.5f, 0));
}

}  // namespace beampipe::reference_raster_test
