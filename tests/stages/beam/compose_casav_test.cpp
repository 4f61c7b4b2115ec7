#include "stages/beam/compose_casav.h"

#include "stages/beam/casav_fragment.h"
#include "tests/stages/beam_pixels.h"

namespace beampipe::compose_casav_test {

constexpr Tile kPixel{0, 0, 1, 1};
constexpr double kRounding = 0x1p-12;  // of a colour up to 1, by each merge
const std::vector<glm::vec3> kRedGreen = {{1, 0, 0}, {0, 1, 0}}, kRedGreenBlue = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};

Aggregate pixel(const SetupTriangles& triangles, MaskSource mask = MaskSource::exact) {
  return beam_pixels(triangles, kRedGreen, kPixel, mask).at(0);
}

TEST(Compose, EmptyPixel) {
  const Aggregate found = pixel({});
  EXPECT_EQ(found.alpha, 0.0f);
  EXPECT_EQ(found.mask, 0u);
  EXPECT_EQ(found.color[0], 0.0f);
}

TEST(Compose, OneEdge) {
  for (const MaskSource mask : {MaskSource::table, MaskSource::exact})
    for (const std::int32_t x : {1, 37, 64, 128, 200, 255}) {  // only the area matters, not the mask
      SetupTriangles triangles = triangles_of({left_of(x, -0.5f)});
      const Aggregate found = pixel(triangles, mask);
      EXPECT_NEAR(found.alpha, x / 256.0, 1e-6);
      EXPECT_NEAR(found.color[0], x / 256.0, 1e-6);
    }
}

TEST(Compose, TwoEdgesOfOneTriangle) {  // the lower left quarter: the right angle is at the pixel's centre
  SetupTriangles triangles = triangles_of({{{128, 128}, {128, 9'000}, {-9'000, 128}}});
  EXPECT_NEAR(pixel(triangles).alpha, 0.25, 1e-6);
}

TEST(Compose, TwoDisjointEdgesAdd) {
  for (const MaskSource mask : {MaskSource::table, MaskSource::exact})
    for (const float z : {-0.75f, -0.25f}) {
      SetupTriangles triangles = triangles_of({left_of(64, -0.5f), right_of(160, z)});
      const Aggregate found = pixel(triangles, mask);
      EXPECT_NEAR(found.alpha, 64 / 256.0 + 96 / 256.0, 1e-6);
      EXPECT_NEAR(found.color[0], 64 / 256.0, 1e-6);
      EXPECT_NEAR(found.color[1], 96 / 256.0, 1e-6);
    }
}

TEST(Compose, SharedEdgeClosesThePixel) {
  for (const MaskSource mask : {MaskSource::table, MaskSource::exact})
    for (const std::int32_t x : {16, 100, 128, 131, 250}) {
      SetupTriangles triangles = triangles_of({left_of(x, -0.5f), right_of(x, -0.5f)});
      const Aggregate found = pixel(triangles, mask);
      EXPECT_NEAR(found.alpha, 1.0, 1e-6);
      EXPECT_NEAR(found.color[0], x / 256.0, 1e-6);
      EXPECT_NEAR(found.color[1], 1 - x / 256.0, 1e-6);
    }
}

// A front triangle over one that covers the whole pixel, in either order, also where the mask cannot represent the
// area: what a local coverage above 1 hides is taken from the positions beside it.
TEST(Compose, FrontOverBackConservesArea) {
  for (const MaskSource mask : {MaskSource::table, MaskSource::exact})
    for (const int front : {0, 1})
      for (std::int32_t x = 1; x < 256; ++x) {
        SetupTriangles triangles;
        if (front == 0) add_triangle(triangles, left_of(x, -0.75f));
        add_triangle(triangles, everywhere(-0.25f));
        if (front == 1) add_triangle(triangles, left_of(x, -0.75f));
        const Aggregate found = pixel(triangles, mask);
        ASSERT_NEAR(found.alpha, 1.0, 1e-6) << x;
        ASSERT_NEAR(found.color[front], x / 256.0, 1e-6) << x;
        ASSERT_NEAR(found.color[1 - front], 1 - x / 256.0, 1e-6) << x;
      }
}

// A wire before a quad: a sliver that narrows from 56 units at y = -30,000 to 0 at 60,000. Within the pixel its mean
// width is that at y = 128.
TEST(Compose, WireBeforeAQuad) {
  const double area = 56.0 * (60'000 - 128) / 90'000 / 256;
  for (const MaskSource mask : {MaskSource::table, MaskSource::exact})
    for (std::int32_t x = 0; x <= 200; x += 5) {
      SetupTriangles triangles =
          triangles_of({{{x, -30'000, -0.75f}, {x, 60'000, -0.75f}, {x + 56, -30'000, -0.75f}}, everywhere(-0.25f)});
      const Aggregate found = pixel(triangles, mask);
      ASSERT_NEAR(found.color[0], area, 2 * kRounding) << x;
      ASSERT_NEAR(found.color[1], 1 - area, 2 * kRounding) << x;
    }
}

// Two triangles with a common edge close the pixel, whatever the edge's direction, if both have positions: nothing of a
// quad behind them shines through.
TEST(Compose, NothingShinesThroughASharedEdge) {
  for (const MaskSource mask : {MaskSource::table, MaskSource::exact})
    for (const std::int32_t x : {16, 100, 128, 131, 230})
      for (const std::int32_t lean : {-9'000, -256, -64, 0, 3, 200, 9'000}) {
        SetupTriangles triangles;
        const ScreenPoint low{x - lean, -9'872}, high{x + lean, 10'128};
        add_triangle(triangles, low, high, {-20'000, 128});
        add_triangle(triangles, high, low, {20'000, 128});
        add_triangle(triangles, everywhere(-0.25f));
        const Aggregate found = beam_pixels(triangles, kRedGreenBlue, kPixel, mask).at(0);
        ASSERT_NEAR(found.color[0] + found.color[1], 1.0, 2 * kRounding) << x << ", " << lean;
        ASSERT_NEAR(found.color[2], 0.0, 1e-6) << x << ", " << lean;
      }
}

// 4 x 4 squares that fill the pixel, each halved: 32 triangles, and two positions for each square. Falling diagonals
// part these two, rising ones do not. The halves that have more positions are drawn first.
SetupTriangles grid_of_32(bool falling) {
  SetupTriangles grid, rest;
  for (std::int32_t y = 0; y < 256; y += 64)
    for (std::int32_t x = 0; x < 256; x += 64) {
      const ScreenPoint a{x, y}, b{x + 64, y}, c{x + 64, y + 64}, d{x, y + 64};
      SetupTriangles first, second;
      add_triangle(first, falling ? a : b, falling ? b : c, falling ? d : a);
      add_triangle(second, falling ? b : c, falling ? c : d, falling ? d : a);
      if (beam_fragments(first, kPixel, MaskSource::exact).list.at(0).tiny) std::swap(first, second);
      grid.triangles.push_back(first.triangles[0]);
      rest.triangles.push_back(second.triangles[0]);
    }
  for (const SetupTriangle& triangle : rest.triangles) grid.triangles.push_back(triangle);
  return grid;
}

TEST(Compose, ThirtyTwoTrianglesWithAPositionEachCloseThePixel) {
  SetupTriangles triangles = grid_of_32(true);
  std::vector<glm::vec3> colors(32, glm::vec3(0, 0, 0));
  for (std::size_t i = 0; i < 32; ++i) colors[i] = {static_cast<float>(i), 1, 0};
  add_triangle(triangles, everywhere(-0.25f));
  colors.emplace_back(0, 0, 1);
  const Aggregate found = beam_pixels(triangles, colors, kPixel, MaskSource::exact).at(0);
  EXPECT_NEAR(found.color[0], 31 * 32 / 2 / 32.0, 1e-4);
  EXPECT_NEAR(found.color[1], 1, 1e-6);
  EXPECT_NEAR(found.color[2], 0, 1e-6);
}

// With rising diagonals every second triangle is a speck, at the same depth as the positions that are there before it,
// and so behind them. Those hold half of the area. Each speck has 1/32 of the pixel, and finds what one position leaves
// open: 1/32 of what the whole pixel leaves open. Three tenths of the surface are lost, and show what is behind.
TEST(Compose, SpecksInAGridOf32LoseThreeTenths) {
  const std::vector<glm::vec3> white(32, glm::vec3(1.0f));
  const Aggregate found = beam_pixels(grid_of_32(false), white, kPixel, MaskSource::exact).at(0);
  EXPECT_NEAR(found.alpha, 1 - std::pow(31.0 / 32, 16) / 2, 1e-5);
  EXPECT_NEAR(found.alpha, 0.699, 1e-3);
}

// A slope that cuts a level surface in the middle of the pixel. Position by position it is in front on the left half.
TEST(Compose, KeptDepthsResolveSurfacesThatCross) {
  for (const bool slope_first : {true, false}) {
    SetupTriangles triangles;
    const auto slope = [](std::int32_t x, std::int32_t y) {
      return ScreenPoint{x, y, -0.5f + 1e-5f * static_cast<float>(x - 128)};
    };
    if (!slope_first) add_triangle(triangles, everywhere(-0.5f));
    add_triangle(triangles, slope(-9'000, -9'000), slope(20'000, -9'000), slope(-9'000, 20'000));
    if (slope_first) add_triangle(triangles, everywhere(-0.5f));
    const Aggregate found =
        beam_pixels(triangles, kRedGreen, kPixel, MaskSource::exact, {.partition = MergeRules::Partition::given}).at(0);
    EXPECT_NEAR(found.alpha, 1, 1e-6);
    EXPECT_NEAR(found.color[0], 0.5, 1e-6);
    EXPECT_NEAR(found.color[1], 0.5, 1e-6);
  }
}

// A depth is compared at each position of each fragment: 32 of a surface that fills the pixel, 16 of half a pixel.
TEST(Compose, KeptDepthsAreTestedWhereFragmentsHavePositions) {
  SetupTriangles triangles = triangles_of({everywhere(-0.75f), left_of(128, -0.5f)});
  Fragments fragments = beam_fragments(triangles, kPixel, MaskSource::exact);
  shade(kRedGreen, fragments.list, fragments.counters);
  const MergePositions positions(hammersley_pattern());
  const auto tests = [&](MergeRules::Partition partition) {
    StageCounters counters;
    const MergeRules rules{
        .slab = MergeRules::Slab::visible, .thickness = MergeRules::Thickness::none, .partition = partition};
    compose(fragments.list, sorted(fragments, kPixel.pixels()), {positions, rules}, counters);
    return counters.position_tests;
  };
  EXPECT_EQ(tests(MergeRules::Partition::given), 32u + 16u);
  EXPECT_EQ(tests(MergeRules::Partition::positions), 0u);  // their depth ranges do not overlap
}

TEST(Compose, EqualDepthKeepsTheEarlier) {
  SetupTriangles triangles = triangles_of({everywhere(-0.5f), everywhere(-0.5f)});
  for (const auto partition : {MergeRules::Partition::positions, MergeRules::Partition::given}) {
    const Aggregate found =
        beam_pixels(triangles, kRedGreen, kPixel, MaskSource::exact, {.partition = partition}).at(0);
    EXPECT_EQ(found.color[0], 1.0f);
    EXPECT_EQ(found.color[1], 0.0f);
  }
}

struct FanAlphas {
  double least = 1, mean = 0;
};

// The alphas of pixels that fans of a single flat colour close. `tiny` selects the pixels with specks or those without.
FanAlphas fan_alphas(Random& random, std::int32_t per_side, bool tiny, MaskSource mask) {
  FanAlphas alphas;
  int fans = 0;
  for (int round = 0; round < 300; ++round) {
    const ScreenPoint hub{random.int32(1, 255), random.int32(1, 255)};
    const SetupTriangles fan = fan_around(hub, 600, per_side, &random);
    const std::vector<Fragment> fragments = beam_fragments(fan, kPixel, mask).list;
    if (std::any_of(fragments.begin(), fragments.end(), [](const Fragment& f) { return f.tiny != 0; }) != tiny)
      continue;
    const std::vector<glm::vec3> white(fan.triangles.size(), glm::vec3(1.0f));
    const Aggregate found = beam_pixels(fan, white, kPixel, mask).at(0);
    EXPECT_NEAR(found.color[0], found.alpha, static_cast<double>(fragments.size()) * kRounding);
    alphas.least = std::min<double>(alphas.least, found.alpha);
    alphas.mean += found.alpha;
    ++fans;
  }
  EXPECT_GT(fans, 10);
  alphas.mean /= fans;
  return alphas;
}

// If every triangle has positions of its own, no two masks overlap and the areas add up.
TEST(Compose, FansWithoutTinyTrianglesCloseThePixel) {
  Random random(141);
  for (const std::int32_t per_side : {1, 2}) {
    const FanAlphas found = fan_alphas(random, per_side, false, MaskSource::exact);
    EXPECT_NEAR(found.least, 1.0, 1e-5) << 4 * per_side << " triangles";
  }
}

// Specks share positions with their neighbours, and the published rules lose coverage there: at worst 37 % of the
// pixel, on average up to a quarter. What is behind shows through. Fewer and larger triangles leak less.
TEST(Compose, FansOfTinyTrianglesLeak) {
  Random random(143);
  for (const MaskSource mask : {MaskSource::table, MaskSource::exact})
    for (const std::int32_t per_side : {1, 2, 4, 8, 16, 32, 64}) {
      const FanAlphas found = fan_alphas(random, per_side, true, mask);
      EXPECT_GT(found.least, per_side == 1 ? 0.93 : 0.63) << 4 * per_side << " triangles";
      EXPECT_GT(found.mean, per_side == 1 ? 0.97 : 0.75) << 4 * per_side << " triangles";
    }
}

// The stage merges the r-th fragments of all pixels at once. Each pixel must get the same result as if it were alone.
TEST(Compose, PixelsDoNotMix) {
  Random random(142);
  const Tile tile{0, 0, 8, 8};
  const SetupTriangles triangles = random_triangles(random, 300);
  Fragments fragments = beam_fragments(triangles, tile, MaskSource::table);
  std::vector<glm::vec3> colors;
  for (std::size_t i = 0; i < triangles.triangles.size(); ++i)
    colors.emplace_back(random.real(0, 1), random.real(0, 1), random.real(0, 1));
  StageCounters counters;
  shade(colors, fragments.list, counters);
  const ABuffer buffer = sorted(fragments, tile.pixels());
  const MergePositions positions(hammersley_pattern());
  const std::vector<Aggregate> found = compose(fragments.list, buffer, {positions}, counters);
  for (std::size_t i = 0; i < tile.pixels(); ++i) {
    Aggregate alone = kEmptyAggregate;
    for (std::uint32_t k = buffer.first[i]; k < buffer.first[i + 1]; ++k)
      alone = SlidesAggregate(merge_formula(merge_fragment(fragments.list[buffer.records[k]]), alone, positions, {}));
    ASSERT_EQ(found[i].alpha, alone.alpha) << "pixel " << i;
    ASSERT_EQ(found[i].mask, alone.mask);
    for (int c = 0; c < 3; ++c) ASSERT_EQ(found[i].color[c], alone.color[c]);
  }
}

// From near to far the coverages are 1/2, 1/4 and 1/4, all independent: 1/2, 1/4 of the remaining 1/2, and 1/4 of the
// remaining 3/8.
TEST(Compose, PlainOver) {
  SetupTriangles triangles = triangles_of({left_of(64, -0.25f), left_of(128, -0.75f), right_of(192, -0.5f)});
  Fragments fragments = beam_fragments(triangles, kPixel, MaskSource::table);
  StageCounters shading, counters;
  shade(std::vector<glm::vec3>{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, fragments.list, shading);
  const Aggregate found = compose_over(fragments.list, sorted(fragments, 1), counters).at(0);
  EXPECT_NEAR(found.color[1], 0.5, 1e-6);
  EXPECT_NEAR(found.color[2], 0.5 / 4, 1e-6);
  EXPECT_NEAR(found.color[0], 0.375 / 4, 1e-6);
  EXPECT_NEAR(found.alpha, 0.5 + 0.125 + 0.09375, 1e-6);
  EXPECT_EQ(counters.items_in, 3u);
  // Per merge: 1 - alpha; a product and a sum each for alpha and three channels; the channels are converted from fp16
  // and back.
  EXPECT_EQ(counters.ops, (OperationCounts{.mul_add = 3 * 4, .add = 3 * 5, .convert = 3 * 6}));
}

}  // namespace beampipe::compose_casav_test
