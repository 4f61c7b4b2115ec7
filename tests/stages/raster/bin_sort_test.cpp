#include "stages/raster/bin_sort.h"

#include "stages/data/pixel_depth.h"
#include "stages/raster/bin_sort_cost.h"
#include "stages/raster/conservative_raster.h"
#include "tests/simd/random.h"
#include "tests/stages/screen_triangles.h"

namespace beampipe::bin_sort_test {

void expect_rounded_to_the_viewer(float depth) {
  const float nearest = nearest_of(sort_key(depth));
  ASSERT_LE(nearest, depth);
  ASSERT_GE(nearest, -1.0f);
  ASSERT_LE(double{depth} - nearest, -double{depth} * 0x1p-16 + 0x1p-140) << depth;  // the last is for denormal numbers
  ASSERT_EQ(sort_key(nearest), sort_key(depth)) << depth;
}

TEST(BinSort, ADepthIsRoundedToTheViewer) {
  Random random(221);
  for (int i = 0; i < 100'000; ++i) expect_rounded_to_the_viewer(random.real32(-1, 0));
  for (int power = -149; power <= 0; ++power) {
    const float depth = -std::ldexp(1.0f, power);
    expect_rounded_to_the_viewer(depth);
    expect_rounded_to_the_viewer(std::nextafter(depth, 0.0f));
    if (power < 0) expect_rounded_to_the_viewer(std::nextafter(depth, -1.0f));
  }
  EXPECT_EQ(nearest_of(sort_key(0.0f)), 0.0f);
  EXPECT_EQ(nearest_of(sort_key(-0.0f)), 0.0f);
  EXPECT_EQ(nearest_of(sort_key(-1.0f)), -1.0f);
}

TEST(BinSort, KeysAreInTheOrderOfDepth) {
  Random random(222);
  for (int i = 0; i < 100'000; ++i) {
    const float scale = std::ldexp(1.0f, static_cast<int>(random.integer(-30, 0)));
    const float a = random.real32(-1, 0) * scale;
    const float b = random.one_in(3) ? std::nextafter(a, 0.0f) : random.real32(-1, 0) * scale;
    ASSERT_EQ(sort_key(std::min(a, b)) <= sort_key(std::max(a, b)), true) << a << " " << b;
    ASSERT_LT(sort_key(a), 1u << 24);
    if (a < b * 1.00002f) {
      ASSERT_LT(sort_key(a), sort_key(b)) << a << " " << b;
    }
  }
  EXPECT_LT(sort_key(-1.0f), sort_key(-0.999f));
  EXPECT_LT(sort_key(-1e-30f), sort_key(0.0f));
}

// Depths of draws whose state puts them in front of the near plane or behind the far plane.
TEST(BinSort, KeysReachBeyondTheNearAndFarPlanes) {
  Random random(224);
  const auto depth = [&] {
    const float scale = std::ldexp(1.0f, static_cast<int>(random.integer(-12, 0)));
    return random.one_in(2) ? random.real32(-2, -1) : random.real32(0, 1) * scale;
  };
  for (int i = 0; i < 100'000; ++i) {
    const float a = depth(), b = random.one_in(3) ? std::nextafter(a, 0.0f) : depth();
    ASSERT_LE(sort_key(std::min(a, b)), sort_key(std::max(a, b))) << a << " " << b;
    ASSERT_LT(sort_key(a), 1u << 24);
    ASSERT_LE(nearest_of(sort_key(a)), a);
    ASSERT_LE(double{a} - nearest_of(sort_key(a)), std::abs(double{a}) * 0x1p-15) << a;
    ASSERT_EQ(sort_key(nearest_of(sort_key(a))), sort_key(a)) << a;
  }
  EXPECT_LT(sort_key(-2.0f), sort_key(-1.999f));
  EXPECT_LT(sort_key(0.0f), sort_key(1e-30f));
}

SetupTriangles flat_triangles(const std::vector<float>& depths) {
  SetupTriangles triangles;
  for (const float z : depths) add_triangle(triangles, everywhere(z));
  return triangles;
}

TEST(BinSort, NearTrianglesComeFirstAndEqualKeysInPrimitiveOrder) {
  Random random(223);
  std::vector<float> depths;
  for (int i = 0; i < 2000; ++i) {
    float z = static_cast<float>(random.integer(-40, 0)) / 40;
    if (random.one_in(2) && z > -1) z = std::nextafter(z, 0.0f);  // often the same key
    depths.push_back(z);
  }
  const SetupTriangles triangles = flat_triangles(depths);
  TriangleList list;
  for (std::uint32_t i = 0; i < depths.size(); ++i)
    if (!random.one_in(4)) list.push_back(i);
  StageCounters counters;
  const OrderedList ordered = bin_sort(triangles, list, {0, 0, 16, 16}, counters);
  TriangleList permuted = ordered.triangles;
  std::sort(permuted.begin(), permuted.end());
  EXPECT_EQ(permuted, list);
  ASSERT_EQ(ordered.watermarks.size(), list.size());
  int ties = 0;
  for (std::size_t i = 1; i < list.size(); ++i) {
    const std::uint32_t previous = ordered.triangles[i - 1], next = ordered.triangles[i];
    ASSERT_LE(sort_key(depths[previous]), sort_key(depths[next])) << i;
    ASSERT_EQ(ordered.watermarks[i], nearest_of(sort_key(depths[next]))) << i;
    if (sort_key(depths[previous]) != sort_key(depths[next])) continue;
    ++ties;
    ASSERT_LT(previous, next) << i;
  }
  EXPECT_GT(ties, 1000);
}

// However much of a key is the same in the whole list.
TEST(BinSort, ListsOfCloseTrianglesAreSortedToo) {
  Random random(225);
  for (int power = 0; power <= 24; ++power) {
    std::vector<float> depths;
    for (int i = 0; i < 300; ++i) depths.push_back(-0.75f - random.real32(-0.25f, 0.25f) * std::ldexp(1.0f, -power));
    StageCounters counters;
    const SetupTriangles triangles = flat_triangles(depths);
    const OrderedList ordered = bin_sort(triangles, all_of(triangles), {0, 0, 16, 16}, counters);
    TriangleList expected = all_of(triangles);
    std::ranges::stable_sort(expected, {}, [&](std::uint32_t triangle) { return sort_key(depths[triangle]); });
    ASSERT_EQ(ordered.triangles, expected) << power;
  }
}

TEST(BinSort, OfAnEmptyList) {
  StageCounters counters;
  const OrderedList ordered = bin_sort({}, {}, {0, 0, 16, 16}, counters);
  EXPECT_TRUE(ordered.triangles.empty());
  EXPECT_TRUE(ordered.watermarks.empty());
  EXPECT_EQ(counters, StageCounters());
}

// Nothing that comes at a place of the list or later is nearer than the watermark there, in any pixel of the bin that
// it touches. Steep triangles and bins away from the origin are included, where rounding matters most.
TEST(BinSort, NothingThatFollowsIsNearerThanTheWatermark) {
  for (std::uint64_t seed = 224; seed < 264; ++seed) {
    Random random(seed);
    const SetupTriangles triangles = random_triangles(random, 300);
    for (const Tile& tile : {Tile{0, 0, 16, 16}, Tile{0, 0, 6, 10}, Tile{8, 8, 12, 12}}) {
      StageCounters counters;
      const OrderedList ordered = bin_sort(triangles, all_of(triangles), tile, counters);
      std::vector<std::size_t> place(triangles.triangles.size());
      for (std::size_t i = 0; i < place.size(); ++i) place[ordered.triangles[i]] = i;
      for (std::size_t i = 1; i < place.size(); ++i) ASSERT_LE(ordered.watermarks[i - 1], ordered.watermarks[i]);
      std::vector<Pair> pairs;
      conservative_raster(triangles, all_of(triangles), tile, counters, pairs);
      ASSERT_FALSE(pairs.empty());
      for (const Pair& pair : pairs) {
        const SetupTriangle& triangle = triangles.triangles[pair.triangle];
        const float nearest =
            pair_bounds(pixel_plane(triangle, pair.x, pair.y), vertex_bounds(triangle.vertex_z)).nearest;
        ASSERT_EQ(nearest, pair.nearest);
        // Watermarks grow along the list, so this holds for all earlier ones.
        EXPECT_LE(ordered.watermarks[place[pair.triangle]], nearest)
            << "triangle " << pair.triangle << ", pixel " << pair.x << " " << pair.y;
      }
    }
  }
}

// Without a slope the watermark is the depth of the triangle, up to the key's rounding: it is no bound of something
// larger.
TEST(BinSort, WatermarksAreTight) {
  SetupTriangles triangles = triangles_of({
      {{0, 0, -0.75f}, {4096, 0, -0.25f}, {0, 4096, -0.75f}}  // farther to the right
  });
  StageCounters counters;
  const auto watermark = [&](const Tile& tile) { return bin_sort(triangles, {0}, tile, counters).watermarks.at(0); };
  EXPECT_NEAR(watermark({0, 0, 16, 16}), -0.75f, 1e-4);
  EXPECT_NEAR(watermark({8, 0, 16, 16}), -0.5f, 1e-4);
  EXPECT_NEAR(watermark({12, 0, 16, 8}), -0.375f, 1e-4);
}

TEST(BinSort, CountsItsWork) {
  const SetupTriangles triangles = flat_triangles(std::vector<float>(37, -0.5f));
  StageCounters counters;
  bin_sort(triangles, all_of(triangles), {0, 0, 16, 16}, counters);
  EXPECT_EQ(counters.items_in, 37u);
  EXPECT_EQ(counters.items_out, 37u);
  // An entry has a triangle's number and a key, of 4 bytes each. Three passes read it and write it; and the key is
  // written once before.
  EXPECT_EQ(counters.bytes_read, 37u * 3 * 8);
  EXPECT_EQ(counters.bytes_written, 37u * (4 + 3 * 8));
  // A key: the bounds of a pair, with two slopes times the size of the bin; a margin, which is a sum of three
  // magnitudes times a constant and is subtracted; a shift and a complement. A pass: a shift and a mask for the digit,
  // the digit's counter is read and increased, and the place is computed.
  OperationCounts expected = pair_bounds_cost();
  expected += vertex_bounds_cost();
  expected += {.mul_add = 2 + 1, .add = 3 + 3 * 2, .bit = 3 + 2 + 3 * 2, .fetch = 3 * 2};
  EXPECT_EQ(counters.ops, expected * 37);
}

}  // namespace beampipe::bin_sort_test
