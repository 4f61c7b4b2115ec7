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
        const double depth = t.depth.at(static_cast<double>(x) / 8192, static_cast<double>(y) / 8192);
        if (!covers(t, x, y, 32) || !(depth < nearest)) continue;
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
    reference_raster({triangles, all_of(triangles), tile}, counters, surface);
    EXPECT_TRUE(surface.owner == brute_force(triangles, tile)) << "round " << round;
  }
}

TEST(ReferenceRaster, FansCoverEverySample) {
  const Tile tile{0, 0, 4, 4};
  const SetupTriangles fan = fan_around({514, 514}, 4'096, 400);  // some of its edges have slope 16 and the like
  ReferenceTile surface(tile);
  StageCounters counters;
  reference_raster({fan, all_of(fan), tile}, counters, surface);
  EXPECT_EQ(std::count(surface.owner.begin(), surface.owner.end(), kNoOwner), 0);
  EXPECT_EQ(counters.lanes_used, tile.pixels() * 4096);  // each sample is in one span
  EXPECT_EQ(counters.lanes_issued, counters.lanes_used);
  EXPECT_EQ(counters.items_out, counters.lanes_used);
  // Per sample, 2 products and 3 sums for the depth, and one comparison. Finding the spans is not charged.
  EXPECT_EQ(counters.ops, (OperationCounts{.mul_add = 2, .add = 4} * counters.lanes_used));
}

// Each column of 1 / (number of samples) px has one sample, and each row of samples has its own part of the height.
TEST(ReferencePatterns, HaveASampleInEveryColumn) {
  for (const std::int32_t columns : {16, 32})
    for (int set = 1; set <= 4; ++set) {
      const ReferencePattern pattern{columns, set};
      std::set<std::int64_t> taken;
      for (std::int64_t row = 0; row < pattern.rows(); ++row) {
        const auto [x, y] = pattern.first_in_row(row);
        EXPECT_EQ(y * pattern.rows() / pattern.units(), row);
        EXPECT_NE(y % (pattern.units() / pattern.rows()), 0) << "on the border of two rows, where vertices lie";
        for (std::int32_t i = 0; i < columns; ++i) taken.insert((x + i * pattern.units() / columns) / 2);
        EXPECT_EQ(x % 2, 1);
      }
      EXPECT_EQ(taken.size(), static_cast<std::size_t>(pattern.samples()));
      EXPECT_EQ(*taken.rbegin(), pattern.samples() - 1);
    }
}

// The error of a half-plane's area, of many of them, for a pattern: in units of the pixel.
std::vector<double> errors_of_areas(const ReferencePattern& pattern) {
  Random random(122);
  const Tile tile{0, 0, 1, 1};
  std::vector<double> errors;
  for (int i = 0; i < 400; ++i) {
    // A parallelogram whose sides cut the upper and the lower border of the pixel: its area is that of a trapezoid.
    const std::int32_t top = random.int32(20, 236), bottom = random.int32(20, 236);
    SetupTriangles triangles = triangles_of({{{-1000, 0, -0.5f}, {top, 0, -0.5f}, {bottom, 256, -0.5f}},
                                             {{-1000, 0, -0.5f}, {bottom, 256, -0.5f}, {-1000, 256, -0.5f}}});
    ReferenceTile surface(tile, pattern);
    StageCounters counters;
    reference_raster({triangles, all_of(triangles), tile}, counters, surface);
    const auto outside = std::count(surface.owner.begin(), surface.owner.end(), kNoOwner);
    errors.push_back(1 - static_cast<double>(outside) / pattern.samples() - (top + bottom) / 512.0);
  }
  return errors;
}

double correlation(const std::vector<double>& a, const std::vector<double>& b) {
  double ab = 0, aa = 0, bb = 0;
  for (std::size_t i = 0; i < a.size(); ++i) ab += a[i] * b[i], aa += a[i] * a[i], bb += b[i] * b[i];
  return ab / std::sqrt(aa * bb);
}

// So that the difference of two pictures tells the error of one.
TEST(ReferencePatterns, ErrIndependently) {
  std::vector<std::vector<double>> errors;
  for (int set = 1; set <= 4; ++set) errors.push_back(errors_of_areas({16, set}));
  for (std::size_t a = 0; a < errors.size(); ++a)
    for (std::size_t b = 0; b < a; ++b) EXPECT_NEAR(correlation(errors[a], errors[b]), 0, 0.3) << a << " " << b;
}

TEST(ReferencePatterns, MoreSamplesErrLess) {
  const auto square = [](const std::vector<double>& errors) {
    double sum = 0;
    for (const double error : errors) sum += error * error;
    return sum;
  };
  EXPECT_LT(4 * square(errors_of_areas({32, 1})), square(errors_of_areas({16, 1})));
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
