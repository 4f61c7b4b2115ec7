#include "stages/beam/beam_fragment.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>

#include "tests/stages/beam_pixels.h"

namespace beampipe {
namespace {

constexpr Tile kPixel{0, 0, 1, 1};
constexpr MaskSource kBoth[] = {MaskSource::table, MaskSource::exact};

constexpr double kPerTriangle = 0x1p-24;  // each triangle rounds its own sum; shared edges cancel exactly

TEST(BeamFragment, AlphasOfATessellationSumToOne) {
  Random random(131);
  SCOPED_TRACE(random.name());
  const Tile tile{0, 0, 4, 4};
  for (int round = 0; round < 100; ++round) {
    const ScreenPoint hub{random.int32(0, 1024), random.int32(0, 1024)};
    const std::int32_t reach = round % 3 == 0 ? (1 << 23) - 2048 : 3'000;
    const SetupTriangles fan = fan_around(hub, reach, random.int32(1, 200), &random);
    double sum[16] = {}, parts[16] = {}, dropped[16] = {};
    std::vector<Pair> pairs;
    StageCounters counters;
    conservative_raster(fan, all_of(fan), tile, counters, pairs);
    for (const Pair& pair : pairs) ++dropped[4 * pair.y + pair.x];
    for (const Fragment& fragment : beam_fragments(fan, tile, MaskSource::table).list)
      sum[fragment.pixel] += fragment.alpha, ++parts[fragment.pixel], --dropped[fragment.pixel];
    for (int pixel = 0; pixel < 16; ++pixel)
      ASSERT_NEAR(sum[pixel], 1.0, kPerTriangle * parts[pixel] + kZeroArea * dropped[pixel]);
  }
}

// The left quarter of the pixel contains columns 0..7 of the Hammersley pattern, whose bits are sorted by x.
TEST(BeamFragment, OneEdge) {
  SetupTriangles triangles;
  add_triangle(triangles, {64, -5'000}, {64, 5'000}, {-5'000, 0});
  for (const MaskSource source : kBoth) {
    const Fragments fragments = beam_fragments(triangles, kPixel, source);
    ASSERT_EQ(fragments.list.size(), 1u);
    const Fragment& fragment = fragments.list[0];
    EXPECT_NEAR(fragment.alpha, 0.25, 5e-7);
    EXPECT_NEAR(fragment.centroid_u, 0.125, 1e-6);
    EXPECT_NEAR(fragment.centroid_v, 0.5, 1e-6);
    EXPECT_EQ(fragment.tiny, 0u);
    // The table's edge is wrong by at most 0.046 px, which is 1.5 times the distance between columns.
    EXPECT_LE(std::popcount(fragment.mask.words[0] ^ 0x000000ffu), source == MaskSource::exact ? 0 : 2);
  }
}

TEST(BeamFragment, FullPixel) {
  SetupTriangles triangles;
  add_triangle(triangles, {-5'000, -5'000, -0.75f}, {20'000, -5'000, -0.75f}, {-5'000, 20'000, -0.25f});
  for (const MaskSource source : kBoth) {
    const Fragments fragments = beam_fragments(triangles, kPixel, source);
    ASSERT_EQ(fragments.list.size(), 1u);
    const Fragment& fragment = fragments.list[0];
    EXPECT_EQ(fragment.alpha, 1.0f);
    EXPECT_EQ(fragment.mask.words[0], ~0u);
    EXPECT_EQ(fragment.centroid_u, 0.5f);
    EXPECT_EQ(fragment.centroid_v, 0.5f);
    // Depth grows by 1/2 over 25,000 units of y.
    EXPECT_NEAR(fragment.z_min, -0.75 + 0.5 * 5'000 / 25'000, 1e-6);
    EXPECT_NEAR(fragment.z_max, -0.75 + 0.5 * 5'256 / 25'000, 1e-6);
    EXPECT_NEAR(fragment.centroid_z, -0.75 + 0.5 * 5'128 / 25'000, 1e-6);
    EXPECT_NEAR(fragment.plane.dzdv, 0.5 * 256 / 25'000, 1e-6);
    EXPECT_NEAR(fragment.plane.dzdu, 0.0, 1e-6);
  }
}

// Between the positions (4, 4) and (12, 132), at (8, 30): 26.3 units from the first, 102 from the second.
TEST(BeamFragment, TinyTriangleTakesThePositionNearestToItsCentroid) {
  SetupTriangles triangles;
  add_triangle(triangles, {7, 29}, {10, 30}, {7, 31});
  for (const MaskSource source : kBoth) {
    const Fragments fragments = beam_fragments(triangles, kPixel, source);
    ASSERT_EQ(fragments.list.size(), 1u);
    EXPECT_TRUE(fragments.list[0].tiny);
    EXPECT_EQ(fragments.list[0].mask.words[0], 1u);
    EXPECT_NEAR(fragments.list[0].alpha, 3.0 / 65536, 5e-7);  // 3 x 2 / 2 units
    EXPECT_NEAR(fragments.list[0].centroid_u, 8.0 / 256, 1.0 / 65536);
  }
}

TEST(BeamFragment, TinyMeansNoPositionAndOneBitNearest) {
  Random random(132);
  SCOPED_TRACE(random.name());
  const SamplePattern pattern = hammersley_pattern();
  const SetupTriangles triangles = random_triangles(random, 4'000);
  int tiny = 0;
  for (const Fragment& fragment : beam_fragments(triangles, {0, 0, 8, 8}, MaskSource::exact).list) {
    const std::uint32_t mask = fragment.mask.words[0];
    ASSERT_NE(mask, 0u);
    if (fragment.tiny == 0) continue;
    ++tiny;
    ASSERT_EQ(std::popcount(mask), 1);
    const auto distance = [&](std::size_t s) {
      return std::hypot(pattern.x[s] / 256.0 - fragment.centroid_u, pattern.y[s] / 256.0 - fragment.centroid_v);
    };
    const double given = distance(static_cast<std::size_t>(std::countr_zero(mask)));
    for (std::size_t s = 0; s < 32; ++s) ASSERT_LE(given, distance(s) + 1e-6);
  }
  EXPECT_GT(tiny, 100);
}

// A speck gets the nearest positions, as many as its area fills, but at most three.
TEST(BeamFragment, TinyTrianglesAreGivenUpToThreePositions) {
  Random random(135);
  SCOPED_TRACE(random.name());
  const SamplePattern pattern = hammersley_pattern();
  const Tile tile{0, 0, 12, 12};
  std::array<int, 4> given{};
  for (const Fragment& fragment : beam_fragments(random_triangles(random, 3'000), tile, MaskSource::exact, 3).list) {
    if (!fragment.tiny) continue;
    const std::uint32_t mask = fragment.mask.words[0];
    ASSERT_EQ(std::popcount(mask), std::min(3, static_cast<int>(std::ceil(fragment.alpha * 32))));
    ++given[static_cast<std::size_t>(std::popcount(mask))];
    double farthest_given = 0, nearest_other = 2;
    for (std::size_t s = 0; s < 32; ++s) {
      const double distance =
          std::hypot(pattern.x[s] / 256.0 - fragment.centroid_u, pattern.y[s] / 256.0 - fragment.centroid_v);
      if (mask >> s & 1) {
        farthest_given = std::max(farthest_given, distance);
      } else {
        nearest_other = std::min(nearest_other, distance);
      }
    }
    ASSERT_LE(farthest_given, nearest_other + 1e-6);
  }
  for (const std::size_t count : {1u, 2u, 3u}) EXPECT_GT(given[count], 5) << count;
}

// Two triangles have a common edge in the pixel. Every position belongs to exactly one of them.
TEST(BeamFragment, MasksOfASharedEdgeAreComplements) {
  Random random(133);
  SCOPED_TRACE(random.name());
  for (int round = 0; round < 2'000; ++round) {
    const ScreenPoint left{-4'000, random.int32(-4'000, 4'000)}, right{4'000, random.int32(-4'000, 4'000)};
    SetupTriangles triangles;
    add_triangle(triangles, left, right, {0, -60'000});
    add_triangle(triangles, left, right, {0, 60'000});
    for (const MaskSource source : kBoth) {
      const std::vector<Fragment> found = beam_fragments(triangles, kPixel, source).list;
      std::uint32_t masks[2] = {};
      for (const Fragment& fragment : found) masks[fragment.triangle] = fragment.tiny ? 0u : fragment.mask.words[0];
      ASSERT_EQ(masks[0], ~masks[1]) << left.y << " to " << right.y;
    }
  }
}

TEST(BeamFragment, MovingByWholePixelsChangesNothing) {
  Random random(134);
  SCOPED_TRACE(random.name());
  for (int round = 0; round < 500; ++round) {
    ScreenPoint p[3];
    for (ScreenPoint& point : p) point = {random.int32(-300, 556), random.int32(-300, 556)};
    SetupTriangles here, there;
    add_triangle(here, p[0], p[1], p[2]);
    for (ScreenPoint& point : p) point.x += 16'000 * 256, point.y += 9'000 * 256;
    add_triangle(there, p[0], p[1], p[2]);
    for (const MaskSource source : kBoth) {
      const auto a = beam_fragments(here, kPixel, source).list;
      const auto b = beam_fragments(there, {16'000, 9'000, 16'001, 9'001}, source).list;
      ASSERT_EQ(a.size(), b.size());
      for (std::size_t i = 0; i < a.size(); ++i) {
        ASSERT_EQ(a[i].alpha, b[i].alpha);
        ASSERT_EQ(a[i].mask.words[0], b[i].mask.words[0]);
        ASSERT_EQ(a[i].centroid_u, b[i].centroid_u);
        ASSERT_EQ(a[i].centroid_v, b[i].centroid_v);
        ASSERT_EQ(a[i].pixel, b[i].pixel);
      }
    }
  }
}

// The triangle fills the lower right quarter of four pixels and only touches the others along its borders.
TEST(BeamFragment, TouchedPixelsWithoutAreaAreDroppedAndCounted) {
  SetupTriangles triangles;
  add_triangle(triangles, {256, 256}, {512, 256}, {256, 512});
  const Fragments fragments = beam_fragments(triangles, {0, 0, 4, 4}, MaskSource::table);
  ASSERT_EQ(fragments.list.size(), 1u);
  EXPECT_EQ(fragments.list[0].pixel, 1u * 4 + 1);
  EXPECT_EQ(fragments.list[0].alpha, 0.5f);
  // All of the pixels 0..2 in x and y, except (2, 2), which it does not touch.
  EXPECT_EQ(fragments.counters.items_in, 8u);
  EXPECT_EQ(fragments.counters.items_out, 1u);
}

}  // namespace
}  // namespace beampipe
