#include "stages/beam/compose_pooled.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "stages/beam/compose_pooled_cost.h"
#include "tests/simd/random.h"
#include "tests/stages/open_pixels.h"

namespace beampipe::compose_pooled_test {

constexpr glm::vec3 kRed{1, 0, 0}, kGreen{0, 1, 0};

void expect_pixel(const PixelColor& found, double alpha, const glm::dvec3& color, double tolerance) {
  EXPECT_NEAR(found.alpha, alpha, tolerance);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(found.color[c], color[c], tolerance) << "channel " << c;
}

std::vector<glm::vec3> random_colors(const SetupTriangles& triangles, Random& random) {
  std::vector<glm::vec3> colors;
  for (std::size_t i = 0; i < triangles.triangles.size(); ++i)
    colors.emplace_back(random.real32(0, 1), random.real32(0, 1), random.real32(0, 1));
  return colors;
}

TEST(ComposePooled, APixelThatOneTriangleCoversHasNoRecord) {
  SetupTriangles triangles;
  add_everywhere(triangles, -0.25f);
  add_everywhere(triangles, -0.75f);
  const std::vector<glm::vec3> colors{kGreen, {0.3f, 0.7f, 0.1f}};
  for (const TriangleList& list : {TriangleList{0, 1}, TriangleList{1, 0}}) {
    OpenTile<8> tile(triangles, colors);
    const PixelColor found = tile.compose(list).at(0);
    EXPECT_EQ(found.alpha, 1.0f);
    EXPECT_EQ(found.color, colors[1]);
    EXPECT_EQ(tile.pixels.words[0].kind, PixelKind::covered);
    EXPECT_EQ(tile.pixels.pool.peak(), 0u);
    EXPECT_EQ(tile.result.shaded.size(), 1u) << "the hidden one is never shaded";
    EXPECT_TRUE(tile.closed.hides(0, 0, -0.74f));
    EXPECT_FALSE(tile.closed.hides(0, 0, -0.75f));
  }
}

TEST(ComposePooled, AnEdgeOverASurface) {
  SetupTriangles triangles;
  add_everywhere(triangles, -0.25f);
  add_left_of(triangles, 128, -0.75f);
  const std::vector<glm::vec3> colors{kRed, kGreen};
  for (const TriangleList& list : {TriangleList{0, 1}, TriangleList{1, 0}}) {
    OpenTile<8> tile(triangles, colors);
    expect_pixel(tile.compose(list).at(0), 1, {0.5, 0.5, 0}, 1e-7);
    EXPECT_EQ(tile.pixels.words[0].kind, PixelKind::open);
    EXPECT_EQ(tile.pixels.pool.used(), 3u) << "one plane and two surfaces: 48 bytes";
  }
  // A third one in front of both takes the pixel, and the record is free again.
  add_everywhere(triangles, -0.9f);
  const std::vector<glm::vec3> three{kRed, kGreen, {0, 0, 1}};
  OpenTile<8> tile(triangles, three);
  expect_pixel(tile.compose({0, 1, 2}).at(0), 1, {0, 0, 1}, 0);
  EXPECT_EQ(tile.pixels.words[0].kind, PixelKind::covered);
  EXPECT_EQ(tile.pixels.pool.used(), 0u);
}

TEST(ComposePooled, AtEqualDepthTheFirstTriangleWins) {
  SetupTriangles triangles;
  for (int i = 0; i < 1000; ++i) add_everywhere(triangles, -0.5f);
  Random random(411);
  const std::vector<glm::vec3> colors = random_colors(triangles, random);
  TriangleList list = all_of(triangles);
  for (int turn = 0; turn < 2; ++turn, std::reverse(list.begin(), list.end())) {
    OpenTile<8> tile(triangles, colors);
    EXPECT_EQ(tile.compose(list).at(0).color, colors[0]);
    EXPECT_LE(tile.pixels.pool.peak(), 3u);
  }
}

// Where a record lies changes nothing.
TEST(ComposePooled, RecordsInMemoryAreThoseOfThePool) {
  for (std::uint64_t seed = 420; seed < 440; ++seed) {
    Random random(seed);
    SCOPED_TRACE(random.name());
    const SetupTriangles triangles = random_triangles(random, 60);
    const std::vector<glm::vec3> colors = random_colors(triangles, random);
    const Tile area{0, 0, 12, 12};
    OpenTile<8> pooled(triangles, colors, area), no_pool(triangles, colors, area, ChunkPool(0));
    const TriangleList list = all_of(triangles);
    const std::vector<PixelColor> found = pooled.compose(list), in_memory = no_pool.compose(list);
    for (std::size_t i = 0; i < area.pixels(); ++i) {
      ASSERT_EQ(in_memory[i].color, found[i].color);
      ASSERT_EQ(in_memory[i].alpha, found[i].alpha);
    }
    EXPECT_GT(no_pool.result.chunks_in_memory, 0u);
    EXPECT_EQ(pooled.result.chunks_in_memory, 0u);
  }
}

// Watermarks and a pool of the least size: collections all the time. 10,000 layers that reach into each other.
TEST(ComposePooled, ManyLayersTakeNoMoreMemoryThanFew) {
  for (const std::uint64_t seed : {451, 452}) {
    Random random(seed);
    SCOPED_TRACE(random.name());
    SetupTriangles triangles;
    while (triangles.triangles.size() < 10'000) {
      const std::int32_t x = random.int32(0, 255), y = random.int32(0, 255);
      const auto point = [&] {
        return ScreenPoint{x + random.int32(-200, 200), y + random.int32(-200, 200), random.real32(-1, 0)};
      };
      add_triangle(triangles, point(), point(), point());
    }
    const std::vector<glm::vec3> colors = random_colors(triangles, random);
    OpenTile<8> tile(triangles, colors, {0, 0, 1, 1}, ChunkPool(0));
    const PixelColor found = tile.compose_sorted().at(0);
    WideMask all;
    for (const Fragment& fragment : tile.fragments) all = all | fragment.mask;
    EXPECT_NEAR(found.alpha * 256, all.count(), 2 + 1e-4);
    for (int c = 0; c < 3; ++c) EXPECT_TRUE(found.color[c] >= 0 && found.color[c] <= found.alpha * 1.00001f);
    EXPECT_LE(tile.pixels.pool.peak(), 26u) << "a record of 30 surfaces";
  }
}

TEST(ComposePooled, MergesBeyondTheMostOwners) {
  SetupTriangles triangles;
  for (int i = 0; i < 8; ++i)
    add_triangle(triangles, {32 * i, -9'000, -0.5f}, {32 * i + 32, -9'000, -0.5f}, {32 * i + 32, 9'000, -0.5f});
  const std::vector<glm::vec3> colors(8, glm::vec3(0.25f, 0.5f, 1.0f));
  OpenTile<8, 2> two(triangles, colors);
  OpenTile<8> enough(triangles, colors);
  const TriangleList list = all_of(triangles);
  const PixelColor merged = two.compose(list).at(0), expected = enough.compose(list).at(0);
  EXPECT_EQ(two.merges[0], 6);
  EXPECT_EQ(enough.merges[0], 0);
  expect_pixel(merged, expected.alpha, expected.color, 1e-6);
}

TEST(ComposePooled, ACollectionFinishesPixels) {
  SetupTriangles triangles;
  add_left_of(triangles, 128, -0.9f);
  add_right_of(triangles, 128, -0.8f);
  add_everywhere(triangles, -0.1f);
  const std::vector<glm::vec3> colors{kRed, kGreen, {0, 0, 1}};
  const std::vector<float> watermarks{-0.9f, -0.8f, -0.1f};
  OpenTile<8> tile(triangles, colors, {0, 0, 1, 1}, ChunkPool(0));  // no room at all: every fragment collects
  expect_pixel(tile.compose({0, 1, 2}, &watermarks).at(0), 1, {0.5, 0.5, 0}, 1e-7);
  EXPECT_EQ(tile.pixels.words[0].kind, PixelKind::finished);
  EXPECT_EQ(tile.pixels.pool.used(), 0u);
  const std::uint32_t first = tile.pixels.records.take(0), second = tile.pixels.records.take(0);
  EXPECT_EQ(first + second, 0u + 1u) << "of the pixel's record and the spare one";
  EXPECT_TRUE(tile.closed.hides(0, 0, -0.99f)) << "nothing can be seen there any more";
  EXPECT_EQ(tile.result.collections, 2u);

  // By hand, with numbers as in BytesOfAnEdgeOverASurface. The first fragment: three chunks; a slot, a plane, the word.
  std::uint64_t read = 67 + 6, written = 8 + 32 + 6;
  // The second: a collection looks at the word and its closed depth, the record's links and its owner. That is final:
  // the record is read, its slot once more, and plane, sums, and word are written. Then the fragment takes what is
  // left, with a chunk for its slot, and closes the pixel.
  read += 6 + 4 + 6 + 52 + 32 + 6 + 8, written += 16 + 32 + 6;
  read += 67 + 32 + 6 + 2 + 52, written += 2 + 8 + 32 + 6;
  // The third: another collection, which reads the sums twice, gives back the record, and writes the colour. The
  // fragment itself is hidden.
  read += 6 + 4 + 4 * 2 + 52 + 32 + 4 * 2 + 8 + 16 + 16, written += 16 + 2 + 6;
  read += 31;
  EXPECT_EQ(tile.composing.bytes_read, read);
  EXPECT_EQ(tile.composing.bytes_written, written);
}

// ---- Costs, by hand ----

TEST(ComposePooled, CostOfStates) {
  // Each plane halves each state so far: an and, and an and-not, of eight words.
  EXPECT_EQ(pooled_costs::split(1, 8).bit, 8u * 2 * 1);
  EXPECT_EQ(pooled_costs::split(3, 8).bit, 8u * 2 * (1 + 2 + 4));
  // Of states 0 to 4, two have bit 0, two bit 1, one bit 2.
  EXPECT_EQ(pooled_costs::join(5, 8).bit, 8u * (2 + 2 + 1));
  EXPECT_EQ(pooled_costs::join(2, 1).bit, 1u);
  EXPECT_EQ(pooled_costs::join(1, 8).bit, 0u);
  // Each pixel is charged by its own planes and states.
  PooledWork work;
  work.splits[1] = 1, work.splits[3] = 2, work.joins[2] = 1, work.joins[5] = 3;
  StageCounters counters;
  charge<8>(work, counters);
  EXPECT_EQ(counters.ops, OperationCounts{.bit = 8 * (2 + 2 * 14 + 1 + 3 * 5)});
}

// Two surfaces become one, by hand:
//  - what is left of each error: a division, and two products; its weight: a sum, a comparison and a choice;
//  - the parts: the sum of the weights, a division, and two products; the sum of the errors;
//  - the hash that rounds the colour: three sums of contents, two products, three shifts and three xors; its upper
//  bits:
//    a shift, a conversion, a sum and a product;
//  - the mean colour: two products and a sum for each channel;
//  - its format: the largest channel (three comparisons), a product, a shift, a sum, a comparison, whether it is black,
//    a difference and a shift; for each channel a product, two sums, two comparisons, a conversion, a shift and an or;
//    the exponent's sum, shift and or, and a choice;
//  - the error's format: a product, two comparisons, its sign, a sum, and a conversion;
//  - the slot: three operations on bits; three for what each of the surfaces is; and the union of two masks of eight
//    words.
TEST(ComposePooled, CostOfAMerge) {
  const OperationCounts expected{.mul_add = 2 * 2 + 2 + 2 + 1 + 3 * 2 + 1 + 3 + 1,
                                 .add = 2 * 3 + 1 + 1 + 3 + 1 + 3 + (3 + 1 + 1 + 1 + 1) + 3 * 4 + 1 + 1 + 4,
                                 .bit = 3 + 3 + 1 + 2 + 3 * 2 + 2 + 3 + 2 * 3 + 8,
                                 .special = 2 + 1,
                                 .convert = 1 + 3 + 1};
  const OperationCounts found = pooled_costs::merge(8);
  EXPECT_EQ(found.mul_add, expected.mul_add);
  EXPECT_EQ(found.add, expected.add);
  EXPECT_EQ(found.bit, expected.bit);
  EXPECT_EQ(found.special, expected.special);
  EXPECT_EQ(found.convert, expected.convert);
}

// A fragment that covers the pixel: a test against the closed depth; no mask, no plane, no slot. It is read without a
// mask (21 bytes), with the closed depth and the pixel's word, which is written. At the end both are read again.
TEST(ComposePooled, CostOfACoveredPixel) {
  SetupTriangles triangles;
  add_everywhere(triangles, -0.5f);
  const std::vector<glm::vec3> colors{kRed};
  OpenTile<8> tile(triangles, colors);
  tile.compose({0});
  EXPECT_EQ(tile.composing.ops, OperationCounts{.add = 1});
  EXPECT_EQ(tile.composing.bytes_read, 21u + 4 + 6);
  EXPECT_EQ(tile.composing.bytes_written, 6u);
  EXPECT_EQ(tile.finishing.ops, OperationCounts{.add = 1});
  EXPECT_EQ(tile.finishing.bytes_read, 4u + 6);
}

// A second one that lies 0.002 behind it, which is less than the change of depth within the pixel: so its nearest depth
// does not hide it, and its plane is compared with that of the first, which is 44 bytes of its setup.
TEST(ComposePooled, CostOfAHiddenFragment) {
  SetupTriangles triangles;
  for (const float behind : {0.0f, 0.002f})
    add_triangle(triangles, {-9'000, -9'000, -0.9f + behind}, {9'000, -9'000, -0.1f + behind},
                 {0, 9'000, -0.5f + behind});
  const std::vector<glm::vec3> colors{kRed, kGreen};
  OpenTile<8> tile(triangles, colors);
  tile.compose({0, 1});
  EXPECT_EQ(tile.composing.items_out, 1u);
  EXPECT_EQ(tile.composing.bytes_read, 2 * (21u + 4 + 6) + (4 + 5 * 8));
  EXPECT_EQ(tile.composing.bytes_written, 6u);
}

// What each fragment reads and writes, where records have a chunk of 16 bytes and a link of 2 for each half of a plane,
// each two surfaces, and the sums. To compute a plane again takes 44 bytes, and where it is of a record 8 for its slot.
TEST(ComposePooled, BytesOfAnEdgeOverASurface) {
  SetupTriangles triangles;
  add_everywhere(triangles, -0.25f);
  add_left_of(triangles, 128, -0.75f);
  add_right_of(triangles, 192, -0.8f);
  add_everywhere(triangles, -0.9f);
  add_triangle(triangles, {50, 50, -0.85f}, {51, 50, -0.85f}, {50, 51, -0.85f});
  const std::vector<glm::vec3> colors(5, kRed);
  constexpr std::uint64_t kWhole = 21 + 4 + 6, kPartial = 57 + 4 + 6, kPlane = 44, kOwner = 8 + kPlane;
  const struct {
    const char* name;
    TriangleList before;
    std::uint32_t last;
    std::uint64_t read, written;
  } cases[] = {
      {"a surface: the word", {}, 0, kWhole, 6},
      {"an edge in front: the plane; three chunks; two slots, a bit plane, the word",
       {0},
       1,
       kPartial + kPlane + 3 * 2,
       2 * 8 + 32 + 6},
      {"an edge in front of one of the two: the record's plane and links; its owner; three chunks more, linked to the "
       "others; a slot, two bit planes, the word",
       {0, 1},
       2,
       kPartial + 32 + 3 * 2 + kOwner + 3 * 2,
       2 + 8 + 64 + 6},
      {"a surface in front of the three: the record, which is given back; for the closed depth, the surface's plane",
       {0, 1, 2},
       3,
       kWhole + 64 + 6 * 2 + 3 * kOwner + kOwner,
       2 + 6},
      {"a speck in front: six words of bit planes, and links; the three owners there; a chunk for the sums, linked to "
       "the others; sums, the word",
       {0, 1, 2},
       4,
       kPartial + 6 * 4 + 6 * 2 + 3 * kOwner + 2,
       2 + 16 + 6},
  };
  for (const auto& [name, before, last, read, written] : cases) {
    TriangleList list = before;
    OpenTile<8> without(triangles, colors), with(triangles, colors);
    without.compose(list);
    list.push_back(last);
    with.compose(list);
    EXPECT_EQ(with.composing.bytes_read - without.composing.bytes_read, read) << name;
    EXPECT_EQ(with.composing.bytes_written - without.composing.bytes_written, written) << name;
  }
}

// A speck in a pixel with two bit planes: for each of three positions a shift and an and of each plane. The three are
// looked up by the centroid: two conversions, three fetches, and the sum of the votes.
TEST(ComposePooled, CostOfASpecksVotes) {
  PooledWork work;
  work.specks[2] = 1;
  StageCounters counters;
  charge<8>(work, counters);
  EXPECT_EQ(counters.ops, (OperationCounts{.add = 3, .bit = 3 * 2 * 2, .fetch = 3, .convert = 2}));
}

// What a single step of each kind is charged, with masks of eight words.
TEST(ComposePooled, CostsOfSteps) {
  struct Step {
    const char* name;
    std::uint64_t PooledWork::*count;
    OperationCounts ops;
    std::uint64_t bytes_read;
  };
  const Step steps[] = {
      {"a fragment, with the closed depth and the word", &PooledWork::fragments, {.add = 1}, 57 + 4 + 6},
      {"what is free and covered, with what is won, and whether that is nothing",
       &PooledWork::masks,
       {.bit = 3 * 8},
       0},
      {"an intersection, and whether it is empty", &PooledWork::masks_tested, {.bit = 2 * 8}, 0},
      {"an intersection that is won", &PooledWork::wins, {.bit = 2 * 8}, 0},
      {"a state without what is taken, and whether that is nothing", &PooledWork::takes, {.bit = 2 * 8}, 0},
      {"a share", &PooledWork::fractions, {.special = 1}, 0},
      {"a comparison of shares", &PooledWork::order_tests, {.add = 1}, 0},
      {"a mean of positions: two sums, and for each a conversion, a division, two products and the pixel's centre",
       &PooledWork::measured,
       {.mul_add = 2 * 2, .add = 2 * 256 + 2, .special = 2, .convert = 2},
       0},
      {"a word that a collection looks at, with its closed depth", &PooledWork::words_scanned, {.add = 1}, 4 + 6},
      {"a word at the end, with its closed depth", &PooledWork::finished, {.add = 1}, 4 + 6},
  };
  for (const Step& step : steps) {
    PooledWork work;
    work.*step.count = 1;
    StageCounters counters;
    charge<8>(work, counters);
    EXPECT_EQ(counters.ops, step.ops) << step.name;
    EXPECT_EQ(counters.bytes_read, step.bytes_read) << step.name;
    EXPECT_EQ(counters.bytes_written, 0u) << step.name;
  }
}

// Whatever is done costs operations: more than one a position where positions are looked at.
TEST(ComposePooled, EveryStepIsCharged) {
  using Work = PooledWork;
  const auto operations = [](std::uint64_t Work::*step) {
    Work work;
    work.*step = 1;
    StageCounters counters;
    charge<8>(work, counters);
    return counters.ops.total();
  };
  constexpr std::uint64_t Work::*kSteps[] = {
      &Work::fragments,   &Work::masks,          &Work::claims,         &Work::masks_tested, &Work::wins,
      &Work::takes,       &Work::planes,         &Work::contests,       &Work::listed,       &Work::words_scanned,
      &Work::measured,    &Work::finality_tests, &Work::pairs_compared, &Work::merges,       &Work::fractions,
      &Work::order_tests, &Work::retirements,    &Work::retired,        &Work::bounds_found, &Work::vertices_bounded,
      &Work::specks_seen, &Work::specks_added,   &Work::finished,       &Work::limited,      &Work::speck_comparisons};
  for (const auto step : kSteps) EXPECT_GT(operations(step), 0u);
  for (const auto step : {&Work::planes_compared, &Work::farthest_found}) EXPECT_GT(operations(step), 256u);
  EXPECT_GT(operations(&Work::bounds_found), 1u) << "the bounds, and which one is farther";
}

}  // namespace beampipe::compose_pooled_test
