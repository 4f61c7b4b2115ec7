// What compose_owners and finish_owners are charged, for cases that are counted by hand.
#include <gtest/gtest.h>

#include "stages/beam/compose_owners_cost.h"
#include "tests/simd/random.h"
#include "tests/stages/open_pixels.h"

namespace beampipe::owners_twins_test {

constexpr std::size_t kWords = 8;
using Five = OpenTile<kWords, 5>;
using Two = OpenTile<kWords, 2>;

// A fragment: pixel, triangle, centroid, area, mask, plane, depth; and the pixel's closed depth. A pixel: three bit
// planes, five slots, and nine sums of two bytes. A plane of an owner: its number in the list, and five doubles of a
// setup triangle.
constexpr std::uint64_t kFragment = 2 + 3 + 2 + 2 + 32 + 16 + 4, kPlane = 4 + 5 * 8;
constexpr std::uint64_t kPixelOfFive = 3 * 32 + 5 * 8 + 9 * 2, kPixelOfTwo = 2 * 32 + 2 * 8 + 9 * 2;

// Each fragment is compared with its pixel's closed depth.
constexpr std::uint64_t kHiddenTest = 1;

// To find a state of b bits in a word takes b - 1 ands and an inversion for each bit that is not set.
OperationCounts masks_of_five() {
  // States 0 to 5 of three bits: 6 * 2 ands and 3 + 2 + 2 + 1 + 2 + 1 inversions. The mask and the empty positions are
  // intersected; so is each slot, whose positions are compared with those that were won.
  return {.add = kHiddenTest, .bit = kWords * (12 + 11 + 1 + 2 * 5)};
}
OperationCounts masks_of_two() {
  // States 0 to 2 of two bits: three ands and 2 + 1 + 1 inversions.
  return {.add = kHiddenTest, .bit = kWords * (3 + 4 + 1 + 2 * 2)};
}
// To put positions into a state: an and and an inversion for each bit.
OperationCounts put(std::uint64_t bits) { return {.bit = kWords * 2 * bits}; }
// Eight population counts are converted and added.
OperationCounts count() { return {.add = kWords - 1, .bit = kWords, .convert = kWords}; }
// An owner's positions, or the final ones, are found and counted. What is found is charged as state 6 of three bits, or
// 3 of two: ands, and an inversion for a bit that is not set.
OperationCounts listed(std::uint64_t bits) {
  OperationCounts ops = count();
  ops += {.bit = kWords * (bits == 3 ? 3 : 1)};
  return ops;
}
// At the end: does one owner have the whole pixel? A test for each slot.
constexpr OperationCounts kFinish{.add = 5};
OperationCounts nearer() { return nearer_cost() * (32 * kWords); }
// A mean position: two sums over the positions, then the mean.
OperationCounts measured() {
  OperationCounts ops = mean_cost();
  ops += {.add = 2 * 32 * kWords};
  return ops;
}

// To close a pixel, beside the planes of its owners, per owner that came from one triangle. The range of its plane: two
// magnitudes, their sum, half of it, and the two ends. Its vertices: four comparisons. The range within them: four
// more. The farthest so far: one.
constexpr OperationCounts kClosingOwner{.mul_add = 1, .add = 1 + 2 + 4 + 4 + 1, .bit = 2};
// An owner that came from several triangles has no vertices.
constexpr OperationCounts kClosingMerged{.mul_add = 1, .add = 1 + 2 + 4 + 1, .bit = 2};

OperationCounts sum(std::initializer_list<OperationCounts> parts) {
  OperationCounts ops;
  for (const OperationCounts& part : parts) ops += part;
  return ops;
}

TEST(OwnersTwins, ASurfaceInPartOfAPixel) {
  SetupTriangles triangles;
  add_left_of(triangles, 100, -0.5f);
  const std::vector<glm::vec3> colors(1, glm::vec3(1.0f));
  Five tile(triangles, colors);
  tile.compose({0});
  EXPECT_EQ(tile.composing.items_in, 1u);
  EXPECT_EQ(tile.composing.items_out, 1u);
  EXPECT_EQ(tile.composing.ops, sum({masks_of_five(), put(3), count()}));
  EXPECT_EQ(tile.composing.bytes_read, kFragment + kPixelOfFive);
  EXPECT_EQ(tile.composing.bytes_written, kPixelOfFive);
  EXPECT_EQ(tile.composing.lanes_issued, 1u);
  EXPECT_EQ(tile.composing.lanes_used, 1u);
  EXPECT_EQ(tile.finishing.items_in, 0u);
  EXPECT_EQ(tile.finishing.ops, sum({kFinish, listed(3) * 3, settle_owner_cost(), put(3), limit_cost()}));
  EXPECT_EQ(tile.finishing.bytes_read, kPixelOfFive);
  EXPECT_EQ(tile.finishing.bytes_written, 0u);
}

TEST(OwnersTwins, AHiddenSurface) {
  SetupTriangles triangles;
  add_everywhere(triangles, -0.5f);
  add_everywhere(triangles, -0.4f);
  const std::vector<glm::vec3> colors(2, glm::vec3(1.0f));
  Five tile(triangles, colors);
  tile.compose({0, 1});
  // The first one closes the pixel: its plane and its depth bounds. The second one is hidden.
  EXPECT_EQ(tile.composing.items_in, 2u);
  EXPECT_EQ(tile.composing.items_out, 1u);
  EXPECT_EQ(tile.composing.ops,
            sum({masks_of_five(), put(3), count(), plane_cost(), kClosingOwner, {.add = kHiddenTest}}));
  EXPECT_EQ(tile.composing.bytes_read, 2 * (kFragment + kPixelOfFive) + kPlane);
  EXPECT_EQ(tile.composing.bytes_written, kPixelOfFive);
  EXPECT_EQ(tile.composing.lanes_issued, 2u);
  EXPECT_EQ(tile.composing.lanes_used, 1u);
}

TEST(OwnersTwins, SurfacesThatInterpenetrate) {
  SetupTriangles triangles;
  add_everywhere(triangles, -0.5f);
  add_triangle(triangles, {90, -20'000, -0.5f}, {10'090, 20'000, -0.25f}, {-9'910, 20'000, -0.75f});
  const std::vector<glm::vec3> colors(2, glm::vec3(1.0f));
  Five tile(triangles, colors);
  tile.compose({0, 1});
  // As above, but the planes are compared at all positions, and the second one takes some.
  EXPECT_EQ(tile.composing.ops, sum({masks_of_five(), put(3), count(), plane_cost(), kClosingOwner, masks_of_five(),
                                     plane_cost(), plane_gap_cost(), nearer(), put(3), count()}));
  EXPECT_EQ(tile.composing.bytes_read, 2 * (kFragment + kPixelOfFive + kPlane));
  EXPECT_EQ(tile.composing.bytes_written, 2 * kPixelOfFive);
  // Two owners take one comparison to sort.
  EXPECT_EQ(tile.finishing.ops,
            sum({kFinish, listed(3) * 4, settle_owner_cost() * 2, put(3) * 2, {.add = 1}, limit_cost()}));
}

TEST(OwnersTwins, ThreeSurfacesInTwoSlots) {
  SetupTriangles triangles;
  add_left_of(triangles, 80, -0.90f);
  add_right_of(triangles, 160, -0.89f);
  add_triangle(triangles, {100, -9'000, -0.2f}, {140, -9'000, -0.2f}, {140, 9'000, -0.2f});
  const std::vector<glm::vec3> colors(3, glm::vec3(1.0f));
  const OperationCounts adding = sum({masks_of_two() * 3, put(2) * 3, count() * 3});
  const std::uint64_t reading = 3 * (kFragment + kPixelOfTwo), planes = 2 * kPlane;

  // Without watermarks the first two become one. The claimed positions become empty, and later they go to the slot that
  // is free; the positions of the two are put together. Three owners make three pairs.
  Two merged(triangles, colors);
  merged.compose({0, 1, 2});
  ASSERT_EQ(merged.merges[0], 1);
  EXPECT_EQ(merged.composing.ops,
            sum({adding, put(2) * 2, plane_cost() * 2, listed(2) * 2, measured() * 3, pair_cost() * 3, merge_cost()}));
  EXPECT_EQ(merged.composing.bytes_read, reading + planes);
  EXPECT_EQ(merged.composing.bytes_written, 3 * kPixelOfTwo);

  // Both are final if the third and all that follow lie behind them: one comparison to sort them, and both are settled.
  Two settled(triangles, colors);
  const std::vector<float> watermarks{-0.9f, -0.89f, -0.2f};
  settled.compose({0, 1, 2}, &watermarks);
  ASSERT_EQ(settled.merges[0], 0);
  EXPECT_EQ(settled.composing.ops, sum({adding,
                                        put(2),
                                        plane_cost() * 2,
                                        finality_cost() * 2,
                                        listed(2) * 3,
                                        {.add = 1},
                                        settle_owner_cost() * 2,
                                        put(2) * 2}));
  EXPECT_EQ(settled.composing.bytes_read, reading + planes);
  EXPECT_EQ(settled.composing.bytes_written, 3 * kPixelOfTwo);

  // A slope through the watermark: the farthest depth of the second owner is needed. It is not final, but the first is.
  SetupTriangles sloped;
  add_left_of(sloped, 80, -0.90f);
  add_triangle(sloped, {160, -9'000, -0.8f}, {160, 9'000, -0.8f}, {9'000, 0, -0.1f});
  sloped.triangles.push_back(triangles.triangles[2]);
  sloped.attributes.push_back(triangles.attributes[2]);
  Two partly(sloped, colors);
  const std::vector<float> within{-0.9f, -0.8f, -0.796f};
  partly.compose({0, 1, 2}, &within);
  ASSERT_EQ(partly.merges[0], 0);
  EXPECT_EQ(partly.composing.ops, sum({adding, put(2), plane_cost() * 2, finality_cost() * 2,
                                       farthest_cost() * (32 * kWords), listed(2) * 2, settle_owner_cost(), put(2)}));
}

TEST(OwnersTwins, AMergedOwnerClosesAPixelWithAnotherOne) {
  SetupTriangles triangles;
  add_left_of(triangles, 80, -0.90f);
  add_right_of(triangles, 160, -0.89f);
  add_everywhere(triangles, -0.2f);
  const std::vector<glm::vec3> colors(3, glm::vec3(1.0f));
  Two tile(triangles, colors);
  tile.compose({0, 1, 2});
  ASSERT_EQ(tile.merges[0], 1);
  const OperationCounts adding = sum({masks_of_two() * 3, put(2) * 3, count() * 3}),
                        contests = sum({plane_cost() * 2, plane_gap_cost() * 2}),
                        merging = sum({put(2) * 2, plane_cost() * 2, listed(2) * 2, measured() * 3, pair_cost() * 3,
                                       merge_cost()});
  EXPECT_EQ(tile.composing.ops, sum({adding, contests, merging, plane_cost() * 2, kClosingOwner, kClosingMerged}));
  EXPECT_EQ(tile.composing.bytes_read, 3 * (kFragment + kPixelOfTwo) + 6 * kPlane);
}

TEST(OwnersTwins, Specks) {
  const auto speck = [](SetupTriangles& triangles, float z) {
    add_triangle(triangles, {41, 42, z}, {43, 42, z}, {41, 43, z});
  };
  const std::vector<glm::vec3> colors(3, glm::vec3(1.0f));
  // For each of three positions: the bits of its state are found by a shift and a mask, and joined.
  const OperationCounts votes{.add = 3, .bit = 3 * 2 * 3, .fetch = 3, .convert = 2};
  SetupTriangles alone;
  speck(alone, -0.5f);
  Five visible(alone, colors);
  visible.compose({0});
  ASSERT_EQ(visible.fragments.size(), 1u);
  ASSERT_TRUE(visible.fragments[0].mask.none());
  EXPECT_EQ(visible.composing.items_in, 1u);
  EXPECT_EQ(visible.composing.items_out, 0u);
  EXPECT_EQ(visible.composing.bytes_read, kFragment + kPixelOfFive);
  EXPECT_EQ(visible.composing.lanes_used, 0u);

  SetupTriangles behind;
  add_left_of(behind, 200, -0.9f);
  speck(behind, -0.5f);
  Five hidden(behind, colors);
  hidden.compose({0, 1});
  ASSERT_EQ(hidden.fragments.size(), 2u);
  EXPECT_EQ(
      hidden.composing.ops,
      sum({masks_of_five(), put(3), count(), votes, plane_cost() * 3, speck_test_cost() * 3, {.add = kHiddenTest}}));
  EXPECT_EQ(hidden.composing.bytes_read, 2 * (kFragment + kPixelOfFive) + 3 * kPlane);
  EXPECT_EQ(hidden.composing.bytes_written, kPixelOfFive);

  SetupTriangles before;
  add_left_of(before, 200, -0.3f);
  add_triangle(before, {40, 41, -0.5f}, {47, 41, -0.5f}, {40, 45, -0.5f});
  Five added(before, colors);
  added.compose({0, 1});
  ASSERT_TRUE(added.fragments.at(1).mask.none());
  EXPECT_EQ(added.composing.ops, sum({masks_of_five(),
                                      put(3),
                                      count(),
                                      votes,
                                      plane_cost() * 3,
                                      speck_test_cost() * 3,
                                      speck_area_cost(),
                                      {.add = kHiddenTest}}));
  EXPECT_EQ(added.composing.bytes_written, 2 * kPixelOfFive);
}

// Bytes and items on random triangles, from what can be seen from outside.
TEST(OwnersTwins, CountsFragmentsAndPixels) {
  Random random(351);
  SCOPED_TRACE(random.name());
  const SetupTriangles triangles = random_triangles(random, 60);
  const std::vector<glm::vec3> colors(60, glm::vec3(0.5f));
  Five tile(triangles, colors, {0, 0, 12, 12});
  tile.compose(all_of(triangles));
  std::uint64_t masks = 0;
  for (const Fragment& fragment : tile.fragments) masks += !fragment.mask.none();
  const StageCounters& counters = tile.composing;
  EXPECT_EQ(counters.items_in, tile.fragments.size());
  EXPECT_EQ(counters.lanes_issued, tile.fragments.size());
  EXPECT_EQ(counters.lanes_used, counters.items_out);
  EXPECT_LE(counters.items_out, masks);
  const std::uint64_t planes = counters.bytes_read - tile.fragments.size() * (kFragment + kPixelOfFive);
  EXPECT_EQ(planes % kPlane, 0u);
  EXPECT_GT(planes, 0u);
  EXPECT_GE(counters.bytes_written, counters.items_out * kPixelOfFive);
  EXPECT_LE(counters.bytes_written, tile.fragments.size() * kPixelOfFive);
}

}  // namespace beampipe::owners_twins_test
