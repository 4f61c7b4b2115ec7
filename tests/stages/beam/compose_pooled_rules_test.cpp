#include "stages/beam/compose_pooled.h"
#include "stages/beam/owner_rules.h"
#include "tests/simd/random.h"
#include "tests/stages/open_pixels.h"

namespace beampipe::compose_pooled_rules_test {

constexpr glm::vec3 kRed{1, 0, 0}, kGreen{0, 1, 0}, kBlue{0, 0, 1};

// How far the result may be from a sum of `surfaces` exact areas: each is rounded to half a unit of FixedSum, and the
// error of its mask to half of 1/32 position.
double step(int surfaces, int positions) { return surfaces * (1.0 / FixedSum::kUnits + 1.0 / 64 / positions) + 1e-6; }

TriangleList reversed(TriangleList list) {
  std::reverse(list.begin(), list.end());
  return list;
}

TriangleList shuffled(TriangleList list, Random& random) {
  random.shuffle(list);
  return list;
}

// The largest one, of alpha and of the colours' channels.
double difference(const PixelColor& a, const PixelColor& b) {
  const glm::dvec3 apart = glm::abs(glm::dvec3(a.color) - glm::dvec3(b.color));
  return std::max({std::abs(double{a.alpha} - b.alpha), apart.r, apart.g, apart.b});
}

// The part of an upright strip that lies in the pixel: two slices whose areas add up to (x1 - x0) / 256.
void add_strip(SetupTriangles& triangles, std::int32_t x0, std::int32_t x1, float z) {
  add_triangle(triangles, {x0, -9'000, z}, {x1, -9'000, z}, {x1, 9'000, z});
  add_triangle(triangles, {x0, -9'000, z}, {x1, 9'000, z}, {x0, 9'000, z});
}

TEST(PooledRules, APixelWithoutFragmentsIsEmpty) {
  const SetupTriangles none;
  const std::vector<glm::vec3> colors;
  OpenTile<4, 7> tile(none, colors, {0, 0, 2, 2});
  for (const PixelColor& found : tile.compose({})) expect_pixel(found, 0, {0, 0, 0}, 0);
}

// Most triangles are within the tolerance of their count; all are after it limits them.
TEST(PooledRules, OneTriangleHasItsExactArea) {
  Random random(231);
  int exact = 0, drawn = 0;
  while (drawn < 500) {
    SetupTriangles triangles;
    const auto point = [&] { return ScreenPoint{random.int32(-100, 356), random.int32(-100, 356), -0.5f}; };
    add_triangle(triangles, point(), point(), point());
    if (triangles.triangles.empty()) continue;
    const std::vector<glm::vec3> colors{{0.25f, 1.0f, 0.75f}};
    OpenTile<8, 5> tile(triangles, colors);
    const PixelColor found = tile.compose({0}).at(0);
    if (tile.fragments.empty() || tile.fragments[0].mask.count() == 256) continue;
    ++drawn;
    const double area = tile.fragments[0].alpha, count = tile.fragments[0].mask.count();
    const double alpha = std::clamp(area, (count - kAreaTolerance) / 256, (count + kAreaTolerance) / 256);
    exact += alpha == area;
    expect_pixel(found, alpha, alpha * glm::dvec3(colors[0]), step(1, 256));
  }
  EXPECT_GT(exact, 400);
}

TEST(PooledRules, TwoHalvesFillAPixel) {
  for (const int x : {77, 128, 201}) {
    for (const float right : {-0.9f, -0.5f, -0.1f}) {
      SetupTriangles triangles = triangles_of({left_of(x, -0.5f), right_of(x, right)});
      const std::vector<glm::vec3> colors{kRed, kGreen};
      for (const TriangleList& list : {TriangleList{0, 1}, TriangleList{1, 0}}) {
        OpenTile<8, 2> tile(triangles, colors);
        const PixelColor found = tile.compose(list).at(0);
        EXPECT_EQ(found.alpha, 1.0f);
        EXPECT_NEAR(found.color.r, x / 256.0, 0.01) << x;
        EXPECT_NEAR(found.color.g, 1 - x / 256.0, 0.01) << x;
        EXPECT_NEAR(found.color.r + found.color.g, 1, 2 * step(2, 256));
        // Within the tolerance of the count, areas are exact.
        const double count = tile.fragments.at(list[0] == 0 ? 0 : 1).mask.count();
        if (std::abs(count - x) < kColorTolerance) {
          EXPECT_NEAR(found.color.r, x / 256.0, 2 * step(2, 256));
        }
      }
    }
  }
}

TEST(PooledRules, ANearSurfaceHidesAFarOne) {
  SetupTriangles triangles = triangles_of({everywhere(-0.25f), everywhere(-0.75f)});
  const std::vector<glm::vec3> colors{kGreen, {0.3f, 0.7f, 0.1f}};
  for (const TriangleList& list : {TriangleList{0, 1}, TriangleList{1, 0}}) {
    OpenTile<8, 2> wide(triangles, colors);
    OpenTile<1, 4> narrow(triangles, colors);
    for (const PixelColor& found : {wide.compose(list).at(0), narrow.compose(list).at(0)}) {
      EXPECT_EQ(found.alpha, 1.0f);
      EXPECT_EQ(found.color, colors[1]);
    }
    EXPECT_EQ(wide.pixels.words[0].kind, PixelKind::covered);
    EXPECT_EQ(wide.pixels.pool.peak(), 0u) << "it needs no record";
    EXPECT_TRUE(wide.closed.hides(0, 0, -0.74f)) << "it is closed at the nearer depth";
    EXPECT_FALSE(wide.closed.hides(0, 0, -0.75f));
    EXPECT_EQ(wide.result.shaded.size(), 1u) << "the hidden one is never shaded";
  }
}

TEST(PooledRules, AnEdgeInTheMiddleHasHalfThePixel) {
  SetupTriangles triangles = triangles_of({left_of(128, -0.5f)});
  const std::vector<glm::vec3> colors{kRed};
  OpenTile<8, 2> tile(triangles, colors);
  expect_pixel(tile.compose({0}).at(0), 0.5, 0.5 * glm::dvec3(kRed), 1e-7);
}

TEST(PooledRules, AnEdgeOverASurface) {
  SetupTriangles triangles = triangles_of({everywhere(-0.25f), left_of(78, -0.75f)});
  const std::vector<glm::vec3> colors{kGreen, kRed};
  for (const TriangleList& list : {TriangleList{0, 1}, TriangleList{1, 0}}) {
    OpenTile<8, 2> tile(triangles, colors);
    const PixelColor found = tile.compose(list).at(0);
    const double count = tile.fragments.at(list[0] == 1 ? 0 : 1).mask.count();
    ASSERT_LE(std::abs(count - 78), kColorTolerance);
    expect_pixel(found, 1, {78 / 256.0, 178 / 256.0, 0}, step(2, 256));
    EXPECT_EQ(tile.pixels.words[0].kind, PixelKind::open);
    EXPECT_EQ(tile.pixels.pool.used(), 3u) << "one plane and two surfaces: 48 bytes";
    EXPECT_EQ(tile.record_bytes.at(0), 54.0f) << "with links of two bytes";
  }
  // A third one in front of both takes the pixel, and the record is free again.
  add_triangle(triangles, everywhere(-0.9f));
  const std::vector<glm::vec3> three{kGreen, kRed, kBlue};
  OpenTile<8, 2> tile(triangles, three);
  expect_pixel(tile.compose({0, 1, 2}).at(0), 1, kBlue, 0);
  EXPECT_EQ(tile.pixels.words[0].kind, PixelKind::covered);
  EXPECT_EQ(tile.pixels.pool.used(), 0u);
}

// A partly covered pixel is not closed; a pixel that several surfaces cover together is, behind the farthest of them.
TEST(PooledRules, ClosesAPixelBehindAllOfItsOwners) {
  SetupTriangles triangles = triangles_of({left_of(100, -0.75f)});
  const std::vector<glm::vec3> colors(3, kRed);
  OpenTile<8, 5> half(triangles, colors);
  half.compose({0});
  EXPECT_FALSE(half.closed.hides(0, 0, 0.0f));
  add_triangle(triangles, right_of(100, -0.5f));
  OpenTile<8, 5> both(triangles, colors);
  both.compose({0, 1});
  EXPECT_TRUE(both.closed.hides(0, 0, -0.49f));
  EXPECT_FALSE(both.closed.hides(0, 0, -0.51f));
  add_triangle(triangles, right_of(100, -0.7f));  // replaces the farther half
  OpenTile<8, 5> nearer(triangles, colors);
  nearer.compose({0, 1, 2});
  EXPECT_TRUE(nearer.closed.hides(0, 0, -0.69f));
  EXPECT_FALSE(nearer.closed.hides(0, 0, -0.71f));
}

TEST(PooledRules, AtEqualDepthTheFirstTriangleWins) {
  SetupTriangles triangles = triangles_of({left_of(126, -0.5f), left_of(198, -0.5f), everywhere(-0.5f)});
  const std::vector<glm::vec3> colors{kRed, kGreen, kBlue};
  TriangleList list = all_of(triangles);
  do {
    OpenTile<8, 4> tile(triangles, colors);
    expect_pixel(tile.compose(list).at(0), 1, {126 / 256.0, 72 / 256.0, 58 / 256.0}, 0.012);
  } while (std::next_permutation(list.begin(), list.end()));
}

TEST(PooledRules, AThousandCoplanarLayersShowTheFirst) {
  Random random(232);
  for (const bool whole : {true, false}) {
    SetupTriangles triangles;
    for (int i = 0; i < 1000; ++i)
      whole ? add_triangle(triangles, everywhere(-0.5f)) : add_triangle(triangles, left_of(130, -0.5f));
    std::vector<glm::vec3> colors(1000, kGreen);
    colors[0] = kRed;
    const TriangleList list = all_of(triangles);
    for (const TriangleList& order : {list, reversed(list), shuffled(list, random)}) {
      OpenTile<8, 2> tile(triangles, colors);
      const PixelColor found = tile.compose(order).at(0);
      EXPECT_EQ(tile.merges[0], 0);
      EXPECT_LE(tile.pixels.pool.peak(), 3u);
      EXPECT_EQ(found.color.g, 0.0f);
      EXPECT_EQ(found.color.r, found.alpha);
      EXPECT_NEAR(found.alpha, whole ? 1.0 : 130.0 / 256, whole ? 0 : step(1, 256));
    }
    OpenTile<8, 2> sorted(triangles, colors);
    EXPECT_EQ(sorted.compose_sorted().at(0).color.g, 0.0f);
  }
}

// Each position shows the nearer plane there.
TEST(PooledRules, PlanesThatInterpenetrateAreSplitByPosition) {
  SetupTriangles triangles = triangles_of({everywhere(-0.5f)});
  // Depth grows by 1/4 per 10 000/256 px to the right, and is -1/2 at x = 90/256.
  add_triangle(triangles, {90, -20'000, -0.5f}, {10'090, 20'000, -0.25f}, {-9'910, 20'000, -0.75f});
  const std::vector<glm::vec3> colors{kGreen, kRed};
  for (const TriangleList& list : {TriangleList{0, 1}, TriangleList{1, 0}}) {
    OpenTile<8, 2> tile(triangles, colors);
    const PixelColor found = tile.compose(list).at(0);
    ASSERT_TRUE(tile.fragments.at(0).mask.count() == 256 && tile.fragments.at(1).mask.count() == 256);
    int left = 0;
    for (const SamplePattern& pattern : tile.positions.patterns)
      for (const std::int32_t x : pattern.x) left += x < 90;
    expect_pixel(found, 1, {left / 256.0, 1 - left / 256.0, 0}, step(2, 256));
    EXPECT_EQ(tile.result.shaded.size(), 2u);
  }
}

// ---- Watermarks ----

// Disjoint slices, near to far: with watermarks two slots are enough, and the result is that of a slot for each.
TEST(PooledRules, WatermarksSettleOwnersWithoutChangingThePicture) {
  SetupTriangles triangles;
  for (int i = 0; i < 12; ++i) add_strip(triangles, 10 + 18 * ((5 * i) % 12), 10 + 18 * ((5 * i) % 12 + 1), -0.9f);
  Random random(233);
  for (std::size_t i = 0; i < triangles.triangles.size(); ++i) {
    SetupTriangle& triangle = triangles.triangles[i];
    const float z = -0.9f + 0.03f * static_cast<float>(i);
    std::fill(triangle.vertex_z, triangle.vertex_z + 3, z);
    triangle.depth.z = z;
  }
  const std::vector<glm::vec3> colors = random_colors(triangles, random);
  OpenTile<8, 2> settled(triangles, colors), merged(triangles, colors);
  OpenTile<8> kept(triangles, colors);
  const PixelColor found = settled.compose_sorted().at(0), expected = kept.compose_sorted(false).at(0);
  EXPECT_EQ(settled.merges[0], 0);
  EXPECT_EQ(kept.merges[0], 0);
  expect_pixel(found, expected.alpha, expected.color, step(1, 256));
  merged.compose_sorted(false);
  EXPECT_EQ(merged.merges[0], 24 - 2);
}

// Random triangles that interpenetrate. Owners that are settled earlier are added in another order, and each gives up
// another share of what was taken in front of it. Where no two owners become one, that changes a pixel by at most 0.54
// positions here, and on average by less than 0.001 positions.
TEST(PooledRules, WatermarksOnRandomTriangles) {
  double worst = 0, sum = 0;
  int pixels = 0, settled_early = 0;
  for (std::uint64_t seed = 240; seed < 300; ++seed) {
    Random random(seed);
    const SetupTriangles triangles = random_triangles(random, 40);
    const std::vector<glm::vec3> colors = random_colors(triangles, random);
    const Tile area{0, 0, 12, 12};
    OpenTile<8, 4> few(triangles, colors, area), never(triangles, colors, area);
    OpenTile<8> many(triangles, colors, area);
    const std::vector<PixelColor> found = few.compose_sorted(), expected = many.compose_sorted(false);
    never.compose_sorted(false);
    for (std::size_t i = 0; i < found.size(); ++i) {
      if (few.merges[i] > 0 || many.merges[i] > 0) continue;
      ++pixels;
      settled_early += never.merges[i] > 0;
      const double apart = difference(found[i], expected[i]);
      if (never.merges[i] == 0) {
        EXPECT_EQ(apart, 0) << i;
      }
      worst = std::max(worst, apart), sum += apart;
    }
  }
  EXPECT_GT(settled_early, 100);
  EXPECT_LT(worst, 1.0 / 256);
  EXPECT_LT(sum / pixels, 0.001 / 256);
}

// ---- More owners than slots ----

template <std::size_t Words, std::size_t Slots>
void expect_merged_strips() {
  SetupTriangles triangles;
  std::vector<glm::vec3> colors;
  constexpr int kStrips = 40;
  for (int i = 0; i < kStrips; ++i) {  // nested: strip i shows 6/256 of the pixel
    add_triangle(triangles, left_of(6 * (i + 1), -0.9f + 0.02f * static_cast<float>((i))));
    colors.push_back(i % 3 == 0 ? kRed : i % 3 == 1 ? kGreen : kBlue);
  }
  Random random(301);
  for (const TriangleList& list :
       {all_of(triangles), reversed(all_of(triangles)), shuffled(all_of(triangles), random)}) {
    OpenTile<Words, Slots> tile(triangles, colors);
    const PixelColor found = tile.compose(list).at(0);
    constexpr double kAll = 6.0 * kStrips / 256;
    WideMask all;
    for (const Fragment& fragment : tile.fragments) all = all | fragment.mask;
    EXPECT_NEAR(found.alpha, all.count() / (32.0 * Words), kAreaTolerance / (32.0 * Words) + 1e-6);
    EXPECT_NEAR(found.alpha, kAll, 3.0 / (32.0 * Words));
    // Each position belongs to one surface, so the colours add up to the area, and no colour is lost for another.
    EXPECT_NEAR(found.color.r + found.color.g + found.color.b, found.alpha, 0.01) << Words << " " << Slots;
    EXPECT_GT(tile.merges[0], 0);
    EXPECT_LE(tile.merges[0], static_cast<float>(kStrips));
  }
}

TEST(PooledRules, MergedOwnersKeepTheirArea) {
  expect_merged_strips<8, 2>();
  expect_merged_strips<8, 5>();
  expect_merged_strips<8, 8>();
  expect_merged_strips<4, 7>();
  expect_merged_strips<2, 4>();
}

// Slices of a pixel that do not overlap: one more than there are slots makes one merge, and so on.
TEST(PooledRules, EachSurfaceWithoutASlotMakesOneMerge) {
  for (int strips = 1; strips <= 20; ++strips) {
    SetupTriangles triangles;
    for (int i = 0; i < strips; ++i)
      add_strip(triangles, 8 + 12 * i, 20 + 12 * i, -0.5f - 0.01f * static_cast<float>(i));
    const std::vector<glm::vec3> colors(triangles.triangles.size(), glm::vec3(0.25f, 0.5f, 1.0f));
    OpenTile<8, 5> tile(triangles, colors);
    const PixelColor found = tile.compose(all_of(triangles)).at(0);
    int with_positions = 0;
    for (const Fragment& fragment : tile.fragments) with_positions += !fragment.mask.none();
    ASSERT_EQ(with_positions, 2 * strips);
    EXPECT_EQ(tile.merges[0], static_cast<float>(std::max(with_positions - 5, 0)));
    EXPECT_NEAR(found.alpha, 12.0 * strips / 256, 0.011);
    // One colour stays one colour, however often it is averaged.
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(found.color[c], found.alpha * colors[0][c], 0.006) << strips;
  }
}

// A pixel of 16 x 16 cells of two triangles each, which brighten from cell to cell and come near to far. Hardly any has
// a slot of its own, and still the mean is right, to the tolerance of colours.
TEST(PooledRules, TheMeanOfManyMergedSurfacesIsTheirMean) {
  for (const bool in_steps : {false, true}) {
    Random random(346);
    std::vector<int> cells(256);
    std::iota(cells.begin(), cells.end(), 0);
    random.shuffle(cells);
    SetupTriangles triangles;
    std::vector<glm::vec3> colors;
    double mean = 0;
    for (int rank = 0; rank < 256; ++rank) {
      const int x = cells[static_cast<std::size_t>(rank)] % 16 * 16,
                y = cells[static_cast<std::size_t>(rank)] / 16 * 16;
      const float z = -0.9f + 0.4f * static_cast<float>(rank) / 256, far = z + 0.25f;
      add_triangle(triangles, {x, y, z}, {x + 16, y, far}, {x + 16, y + 16, far});
      add_triangle(triangles, {x, y, z}, {x + 16, y + 16, far}, {x, y + 16, z});
      const float bright = in_steps ? (rank < 128 ? 0.5f : 0.9f) : 0.5f + 0.4f * static_cast<float>(rank) / 256;
      mean += bright / 256;
      colors.insert(colors.end(), 2, glm::vec3(bright, 0.5f * bright, 1.0f));
    }
    ASSERT_EQ(triangles.triangles.size(), 512u);
    OpenTile<8, 5> tile(triangles, colors);
    const PixelColor found = tile.compose_sorted().at(0);
    EXPECT_GT(tile.merges[0], 200);
    EXPECT_NEAR(found.alpha, 1, kAreaTolerance / 256);
    EXPECT_NEAR(found.color[0], mean, 0.9 * (kColorTolerance + 2) / 256);
    EXPECT_NEAR(found.color[1], mean / 2, 0.9 * (kColorTolerance + 2) / 256);
    EXPECT_NEAR(found.color[2], 1, (kColorTolerance + 2) / 256);
  }
}

// The two whose depths are closest become one: the surface far behind them keeps its own colour and its own depth.
TEST(PooledRules, MergesTheClosestSurfaces) {
  SetupTriangles triangles;
  std::vector<glm::vec3> colors{kRed, kGreen, kBlue, {0, 0, 0}};
  add_triangle(triangles, left_of(80, -0.90f));
  add_triangle(triangles, right_of(160, -0.89f));
  add_triangle(triangles, everywhere(-0.2f));
  OpenTile<8, 2> three(triangles, colors);
  EXPECT_NEAR(three.compose(all_of(triangles)).at(0).color.b, 80.0 / 256, 0.012);
  EXPECT_EQ(three.merges[0], 1);
  // A fourth surface between them hides the far one only.
  add_triangle(triangles, everywhere(-0.5f));
  OpenTile<8, 2> four(triangles, colors);
  const PixelColor found = four.compose(all_of(triangles)).at(0);
  EXPECT_NEAR(found.color.b, 0, 1e-6);
  EXPECT_NEAR(found.color.r, 80.0 / 256, 0.012);
  EXPECT_NEAR(found.color.g, 96.0 / 256, 0.012);
}

// Of surfaces at equal depth, those become one that are closest in the order of the draws, here the second and the
// third. A fourth one hides both of them, so the first one has kept its colour.
TEST(PooledRules, AtEqualDepthTheClosestInTheTraceBecomeOne) {
  SetupTriangles triangles = triangles_of({left_of(80, -0.5f)});
  for (int i = 0; i < 4; ++i) add_triangle(triangles, everywhere(-0.1f));  // not in the list
  add_triangle(triangles, {80, -9'000, -0.5f}, {160, -9'000, -0.5f}, {160, 9'000, -0.5f});
  add_triangle(triangles, right_of(160, -0.5f));
  add_triangle(triangles, right_of(80, -0.9f));
  const glm::vec3 black(0);
  const std::vector<glm::vec3> colors{kRed, black, black, black, black, kGreen, kBlue, black};
  OpenTile<8, 2> tile(triangles, colors);
  const PixelColor found = tile.compose({0, 5, 6, 7}).at(0);
  EXPECT_EQ(tile.merges[0], 1);
  EXPECT_NEAR(found.color.r, 80.0 / 256, 0.012);
  EXPECT_NEAR(found.color.g, 0, 1e-6);
  EXPECT_NEAR(found.color.b, 0, 1e-6);
}

// The loss counts the positions of the smaller surface, whichever comes first: here 2, at a distance of 0.25 at either
// mean.
TEST(PooledRules, ALossIsThatOfTheSmallerSurface) {
  const PlacedSurface<float> small{2, {-0.5f, 0, 0}, -0.25f, 0}, large{5, {-0.25f, 0, 0}, 0.25f, 0};
  EXPECT_EQ(merge_loss(small, large), 1.0f);
  EXPECT_EQ(merge_loss(large, small), 1.0f);
}

// Two surfaces that become one have the depth of the larger one: a surface between the two depths loses or wins all.
TEST(PooledRules, MergedSurfacesHaveTheDepthOfTheLargerOne) {
  for (const bool larger_is_nearer : {true, false}) {
    SetupTriangles triangles = triangles_of({left_of(160, larger_is_nearer ? -0.56f : -0.54f),
                                             right_of(216, larger_is_nearer ? -0.54f : -0.56f),
                                             {{180, -9'000, -0.1f}, {200, -9'000, -0.1f}, {200, 9'000, -0.1f}},
                                             everywhere(-0.55f)});
    const std::vector<glm::vec3> colors{kRed, kRed, kGreen, kBlue};
    for (const TriangleList& list : {TriangleList{0, 1, 2, 3}, TriangleList{1, 0, 2, 3}}) {
      OpenTile<8, 2> tile(triangles, colors);
      const PixelColor found = tile.compose(list).at(0);
      EXPECT_EQ(tile.merges[0], 1);
      EXPECT_NEAR(found.color.r, larger_is_nearer ? 200.0 / 256 : 0, 0.012);
      EXPECT_NEAR(found.color.b, larger_is_nearer ? 56.0 / 256 : 1, 0.012);
    }
  }
}

// A surface in front of several owners frees the slots of all.
TEST(PooledRules, HiddenOwnersGiveBackTheirSlots) {
  SetupTriangles triangles =
      triangles_of({left_of(128, -0.2f), right_of(128, -0.2f), everywhere(-0.5f), left_of(78, -0.8f)});
  const std::vector<glm::vec3> colors{kBlue, kBlue, kGreen, kRed};
  OpenTile<8, 2> tile(triangles, colors);
  expect_pixel(tile.compose(all_of(triangles)).at(0), 1, {78 / 256.0, 178 / 256.0, 0}, 0.012);
  EXPECT_EQ(tile.merges[0], 0);
  EXPECT_EQ(tile.result.shaded.size(), 2u);
}

// A merged surface of which little remains visible does not take area away from others, whatever the error of its mask.
TEST(PooledRules, HiddenPartsOfMergedSurfacesTakeNoArea) {
  int negative = 0;
  for (int x = 48; x < 56; ++x) {
    for (int left = 0; left < 24; ++left) {
      SetupTriangles triangles = triangles_of(
          {left_of(x, -0.5f), right_of(154, -0.499f), {{60, -9'000, -0.1f}, {90, -9'000, -0.1f}, {90, 9'000, -0.1f}}});
      // All but a few positions at the upper left corner.
      add_triangle(triangles, {left - 3'000, 3'000, -0.9f}, {left + 3'000, -3'000, -0.9f}, {20'000, 20'000, -0.9f});
      const std::vector<glm::vec3> colors(4, glm::vec3(1.0f));
      OpenTile<8, 2> tile(triangles, colors);
      PixelObservers observers(1);
      observers[0] = std::make_unique<PixelObserver>();
      observers[0]->add_positions(std::vector<glm::vec2>(256));
      tile.observers = &observers;
      tile.compose({0, 2, 1, 3});
      ASSERT_EQ(tile.merges[0], 1);
      float errors = 0;
      for (const std::size_t i : {0, 2}) {
        const Fragment& fragment = tile.fragments.at(i);
        errors += fragment.alpha * 256 - static_cast<float>(fragment.mask.count());
      }
      const Fragment& cover = tile.fragments.at(3);
      if (cover.mask.count() == 256) continue;
      negative += errors < 0;
      EXPECT_GE(observers[0]->history.estimates->analytic.a, cover.alpha - step(3, 256)) << x << " " << left;
    }
  }
  EXPECT_GT(negative, 5);
}

TEST(PooledRules, TenThousandRandomFragmentsInOnePixel) {
  for (const std::uint64_t seed : {311, 312, 313, 314}) {
    Random random(seed);
    SetupTriangles triangles;
    // Up to 16 px wide, or up to 1/4 px; in one half of the runs nothing covers the right part of the pixel.
    const std::int32_t right = seed % 2 ? 150 : 400;
    while (triangles.triangles.size() < 10'000) {
      const std::int32_t reach = random.one_in(2) ? 64 : 4096;
      const std::int32_t x = random.int32(0, 255), y = random.int32(0, 255);
      const auto point = [&] {
        return ScreenPoint{std::min(x + random.int32(-reach, reach), right), y + random.int32(-reach, reach),
                           random.real32(-1, 0)};
      };
      add_triangle(triangles, point(), point(), point());
    }
    constexpr float kBrightest = 7.5f;
    const std::vector<glm::vec3> colors = random_colors(triangles, random, 0, kBrightest);
    const auto check = [&](auto&& tile, const PixelColor& found) {
      WideMask all;
      for (const Fragment& fragment : tile.fragments) all = all | fragment.mask;
      constexpr double kRounding = 1e-5;
      EXPECT_GE(found.alpha, 0.0f);
      EXPECT_LE(found.alpha, 1.0f);
      EXPECT_NEAR(found.alpha * 256, all.count(), kAreaTolerance + kRounding);
      EXPECT_EQ(found.alpha == 1.0f, all.count() == 256);
      for (int c = 0; c < 3; ++c) {
        EXPECT_GE(found.color[c], 0.0f);
        EXPECT_LE(found.color[c], found.alpha * kBrightest * (1 + kRounding));
      }
      EXPECT_EQ(tile.composing.items_in, tile.fragments.size());
    };
    OpenTile<8, 5> unsorted(triangles, colors), sorted(triangles, colors);
    check(unsorted, unsorted.compose(all_of(triangles)).at(0));
    EXPECT_GT(unsorted.fragments.size(), 5000u);
    check(sorted, sorted.compose_sorted().at(0));
    EXPECT_TRUE(unsorted.merges[0] > 0 && sorted.merges[0] > 0);
    // Watermarks and a pool of the least size: collections all the time.
    OpenTile<8> collecting(triangles, colors, {0, 0, 1, 1}, ChunkPool(0));
    check(collecting, collecting.compose_sorted().at(0));
    EXPECT_LE(collecting.pixels.pool.peak(), 26u) << "a record of 30 surfaces";
  }
}

// Without merges the picture does not depend on the order in which triangles come: the nearest own the positions. Only
// roundings differ, by 3.1e-5 here. Specks are left out: they are compared with the owners that came earlier.
TEST(PooledRules, TheOrderOfArrivalDoesNotMatterWhileSlotsSuffice) {
  double worst = 0;
  for (std::uint64_t seed = 320; seed < 340; ++seed) {
    Random random(seed);
    const SetupTriangles triangles = random_triangles(random, 30);
    const std::vector<glm::vec3> colors = random_colors(triangles, random);
    OpenTile<8> one(triangles, colors, {0, 0, 12, 12}), other(triangles, colors, {0, 0, 12, 12});
    const TriangleList list = all_of(triangles);
    const std::vector<PixelColor> found = one.compose(list), expected = other.compose(shuffled(list, random));
    for (std::size_t i = 0; i < found.size(); ++i) {
      const bool specks = std::any_of(one.fragments.begin(), one.fragments.end(), [&](const Fragment& fragment) {
        return fragment.pixel == i && fragment.mask.none();
      });
      ASSERT_EQ(one.merges[i] + other.merges[i], 0);
      if (!specks) worst = std::max(worst, difference(found[i], expected[i]));
    }
  }
  EXPECT_LT(worst, 1e-4);  // three units of FixedSum
}

// ---- Specks ----

// A triangle between mask positions, around (x, y) in 1/256 px; its area is 2/256^2 px times `size`.
void add_speck(SetupTriangles& triangles, std::int32_t x, std::int32_t y, float z, bool mirrored = false,
               std::int32_t size = 1) {
  const ScreenPoint p{x, y, z}, q{x + 2 * size, y, z}, r{x, y + 2, z};
  mirrored ? add_triangle(triangles, p, r, q) : add_triangle(triangles, p, q, r);
}

struct SpeckCase {
  std::int32_t x, y;
};

// A place where such a triangle covers no position.
SpeckCase place_of_speck(Random& random, std::int32_t x0, std::int32_t x1) {
  for (;;) {
    const SpeckCase place{random.int32(x0, x1), random.int32(20, 230)};
    SetupTriangles triangles;
    add_speck(triangles, place.x, place.y, -0.5f, false, 2);
    const std::vector<glm::vec3> colors{kRed};
    OpenTile<8, 5> tile(triangles, colors);
    tile.compose({0});
    if (tile.fragments.size() == 1 && tile.fragments[0].mask.none()) return place;
  }
}

TEST(PooledRules, AVisibleSpeckAddsItsArea) {
  Random random(341);
  for (int i = 0; i < 20; ++i) {
    const SpeckCase place = place_of_speck(random, 20, 230);
    SetupTriangles triangles;
    add_speck(triangles, place.x, place.y, -0.5f, i % 2, 2);
    const std::vector<glm::vec3> colors{{1.0f, 0.5f, 0.0f}};
    OpenTile<8, 5> tile(triangles, colors);
    const double area = 4.0 / 65536;
    expect_pixel(tile.compose({0}).at(0), area, area * glm::dvec3(colors[0]), step(1, 256));
    EXPECT_GT(tile.pixels.words[0].area, 0.0f);
  }
}

TEST(PooledRules, ASpeckBehindAnOwnerAddsNothing) {
  Random random(342);
  for (int i = 0; i < 20; ++i) {
    const SpeckCase place = place_of_speck(random, 20, 90);
    const auto area_with = [&](float z) {
      SetupTriangles triangles = triangles_of({left_of(130, -0.5f)});
      add_speck(triangles, place.x, place.y, z, false, 2);
      const std::vector<glm::vec3> colors{kGreen, kRed};
      OpenTile<8, 5> tile(triangles, colors);
      const PixelColor found = tile.compose({0, 1}).at(0);
      EXPECT_EQ(tile.fragments.size(), 2u);
      return found;
    };
    EXPECT_EQ(area_with(-0.3f).color.r, 0.0f);
    EXPECT_NEAR(area_with(-0.3f).alpha, 130.0 / 256, step(1, 256));
    EXPECT_NEAR(area_with(-0.7f).color.r, 4.0 / 65536, step(1, 256));
    EXPECT_GT(area_with(-0.7f).color.r, 0.0f);
  }
}

TEST(PooledRules, ASpeckAtAFinalPositionAddsNothing) {
  Random random(343);
  const SpeckCase place = place_of_speck(random, 20, 50);
  for (const bool final : {true, false}) {
    SetupTriangles triangles = triangles_of({left_of(80, -0.9f), right_of(200, -0.89f)});
    add_strip(triangles, 100, 110, -0.5f);
    add_speck(triangles, place.x, place.y, -0.95f, false, 2);  // as if the sort had failed
    const std::vector<glm::vec3> colors{kGreen, kGreen, kGreen, kGreen, kRed};
    // A third owner settles the first two, if the watermark says that they are final.
    const std::vector<float> watermarks(5, final ? -0.6f : -0.99f);
    OpenTile<8, 2> tile(triangles, colors);
    const PixelColor found = tile.compose(all_of(triangles), &watermarks).at(0);
    EXPECT_EQ(tile.merges[0] > 0, !final);
    EXPECT_EQ(found.color.r > 0, !final);
  }
}

TEST(PooledRules, TheSidesOfAThinBodyCountOnce) {
  Random random(344);
  const std::vector<glm::vec3> colors(4, kRed);
  for (int i = 0; i < 20; ++i) {
    const SpeckCase place = place_of_speck(random, 20, 230);
    const auto area_of = [&](std::initializer_list<std::pair<bool, int>> sides) {
      SetupTriangles triangles;
      for (const auto& [mirrored, size] : sides) add_speck(triangles, place.x, place.y, -0.5f, mirrored, size);
      OpenTile<8, 5> tile(triangles, colors);
      const PixelColor found = tile.compose(all_of(triangles)).at(0);
      EXPECT_EQ(tile.fragments.size(), sides.size());
      return found.alpha * 65536;
    };
    EXPECT_EQ(area_of({{false, 2}, {false, 2}}), 8.0f);
    EXPECT_EQ(area_of({{false, 2}, {true, 2}}), 4.0f);
    EXPECT_EQ(area_of({{true, 2}, {false, 2}}), 4.0f);
    EXPECT_EQ(area_of({{true, 1}, {false, 2}}), 4.0f);
    EXPECT_EQ(area_of({{false, 2}, {true, 1}}), 4.0f);
    EXPECT_EQ(area_of({{false, 2}, {true, 2}, {true, 2}, {false, 2}}), 8.0f);
  }
}

// ---- The result is limited to what counted positions explain ----

TEST(PooledRules, TheEstimateIsLimited) {
  Random random(345);
  int kept = 0, moved = 0;
  for (int i = 0; i < 100'000; ++i) {
    const float positions = static_cast<float>(32 << random.integer(0, 3));
    const float brightest = random.one_in(2) ? 1.0f : 20.0f;
    const float count = static_cast<float>(random.integer(0, static_cast<std::int64_t>(positions)));
    Estimate<float> counted{count / positions, {}}, analytic{random.real32(1e-4, 1), {}};
    if (random.one_in(2))  // a close one
      analytic.area = std::clamp(counted.area + random.real32(-2.5, 2.5) / positions, 1e-4f, 1.0f);
    double largest = 0;
    for (int c = 0; c < 3; ++c) {
      const float channel = random.real32(0, brightest);
      counted.color[c] = counted.area * channel;
      analytic.color[c] = analytic.area * (random.one_in(2) ? channel : random.real32(0, brightest));
      largest = std::max({largest, double{analytic.color[c]} / analytic.area, count > 0 ? double{channel} : 0.0});
    }
    const Estimate<float> result = limited_estimate(analytic, counted, positions);
    constexpr double kRounding = 1e-6;
    ASSERT_GE(result.area, 0.0f);
    ASSERT_LE(result.area, 1.0f);
    ASSERT_LE(std::abs(result.area - counted.area), 2.0 / positions + kRounding);
    if (count == positions) {
      ASSERT_EQ(result.area, 1.0f);
    } else if (std::abs(analytic.area - counted.area) < 2.0f / positions - kRounding) {
      ASSERT_EQ(result.area, analytic.area);
    } else {  // moved to the nearer end of the range
      ASSERT_LE(std::abs(result.area - analytic.area),
                std::max(std::abs(analytic.area - counted.area) - 2.0 / positions, 0.0) + kRounding);
    }
    const double tolerance = 3.0 / positions * largest;
    for (int c = 0; c < 3; ++c) {
      const double scaled = double{analytic.color[c]} * result.area / analytic.area;
      const double rounding = kRounding * brightest;
      ASSERT_GE(result.color[c], -rounding);
      ASSERT_LE(result.color[c], largest * result.area + rounding);
      ASSERT_LE(std::abs(result.color[c] - counted.color[c]), tolerance + rounding);
      if (std::abs(scaled - counted.color[c]) < tolerance - rounding) {
        ++kept;
        ASSERT_NEAR(result.color[c], scaled, rounding);
      } else {
        ++moved;
        ASSERT_NEAR(std::abs(result.color[c] - counted.color[c]), tolerance, rounding);
      }
    }
  }
  EXPECT_GT(kept, 50'000);
  EXPECT_GT(moved, 50'000);
  // What has lost all of its area to the surfaces in front is counted all the same, within the tolerances.
  const Estimate<float> none = limited_estimate<float>({0, {0, 0, 0}}, {10 / 256.0f, {5 / 256.0f, 0, 0}}, 256);
  EXPECT_EQ(none.area, 8 / 256.0f);
  EXPECT_NEAR(none.color[0], (5 - 3 * 0.5) / 256, 1e-7);
  EXPECT_EQ(none.color[1], 0);
}

}  // namespace beampipe::compose_pooled_rules_test
