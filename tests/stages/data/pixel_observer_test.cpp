// What an observer tells of the pixels that compose_pooled returns.
#include "stages/data/pixel_observer.h"

#include "tests/stages/open_pixels.h"

namespace beampipe::pixel_observer_test {

struct Explained {
  double farthest = 0;       // from a pixel to the sum of its triangles' weights times colours, in any channel
  double of_unmerged = 0;    // the same, of pixels in which no surfaces became one
  double sum_of_errors = 0;  // over pixels and channels
  int pixels = 0, merged = 0, specks = 0;
};

PixelObservers observers_of(std::size_t pixels, const PositionSet& positions) {
  PixelObservers observers(pixels);
  for (auto& each : observers) {
    each = std::make_unique<PixelObserver>();
    each->add_positions(std::vector<glm::vec2>(static_cast<std::size_t>(positions.count())));
  }
  return observers;
}

// Composes the triangles in every order and adds up what the weights of each pixel explain.
template <std::size_t Words, std::size_t Slots>
void explain(const SetupTriangles& triangles, const std::vector<glm::vec3>& colors, Explained& found) {
  for (const bool sorted : {true, false}) {
    OpenTile<Words, Slots> plain(triangles, colors, {0, 0, 12, 12}), weighed(triangles, colors, {0, 0, 12, 12});
    const PixelObservers observers = observers_of(weighed.tile.pixels(), weighed.positions);
    weighed.observers = &observers;
    const std::vector<PixelColor> expected = plain.compose_sorted(sorted), pixels = weighed.compose_sorted(sorted);
    EXPECT_EQ(weighed.composing, plain.composing) << "recording is charged nothing";
    EXPECT_EQ(weighed.finishing, plain.finishing);
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      ASSERT_EQ(pixels[i].color, expected[i].color);
      ASSERT_EQ(pixels[i].alpha, expected[i].alpha);
      double area = 0;
      glm::dvec3 sum(0.0);
      std::set<std::uint32_t> seen;
      bool merged = false;
      for (const SurfaceWeight& each : observers[i]->history.weights()) {
        EXPECT_TRUE(seen.insert(each.triangle).second) << "a triangle has one weight";
        ASSERT_GE(each.weight, 0);
        area += each.weight;
        sum += double{each.weight} * glm::dvec3(colors[each.triangle]);
        merged |= each.order > 0;
        found.specks += each.tiny;
      }
      EXPECT_NEAR(area, pixels[i].alpha, 1e-5);
      for (int c = 0; c < 3; ++c) {
        const double error = std::abs(sum[c] - pixels[i].color[c]);
        found.farthest = std::max(found.farthest, error);
        if (!merged) found.of_unmerged = std::max(found.of_unmerged, error);
        found.sum_of_errors += error;
      }
      ++found.pixels;
      found.merged += merged;
    }
  }
}

// What a pixel's colours are rounded to: sums of 15 bits, and means of merged owners with a shared exponent, whose
// mantissas have 9 bits. A mean of colours up to 1 is off by up to 1/512, and it may be merged again.
constexpr double kOfSums = 2e-4, kOfMerged = 2.0 / 512;

template <class Color>
Explained explain_random(std::uint64_t seed, int count, Color&& color) {
  Random random(seed);
  Explained found;
  for (int round = 0; round < 4; ++round) {
    const SetupTriangles triangles = random_triangles(random, count);
    std::vector<glm::vec3> colors;
    for (int i = 0; i < count; ++i) colors.push_back(color(random));
    explain<8, 5>(triangles, colors, found);
    explain<4, 7>(triangles, colors, found);
    explain<2, 4>(triangles, colors, found);
    explain<1, 2>(triangles, colors, found);
  }
  return found;
}

glm::vec3 gray(Random& random) { return glm::vec3(random.real32(0, 1)); }
glm::vec3 colorful(Random& random) { return {random.real32(0, 1), random.real32(0, 1), random.real32(0, 1)}; }

TEST(PixelObserver, ExplainGrayPixels) {
  const Explained few = explain_random(611, 6, gray);
  EXPECT_LE(few.merged, 1);
  EXPECT_LT(few.of_unmerged, kOfSums);
  EXPECT_LT(few.farthest, kOfMerged);
  const Explained many = explain_random(612, 60, gray);
  EXPECT_GT(many.merged, 250);
  EXPECT_GT(many.specks, 100);
  EXPECT_LT(many.farthest, kOfMerged);
  EXPECT_LT(many.sum_of_errors / (3 * many.pixels), kOfSums / 2);
}

// Where the limits of the two estimates move the channels of a colour by different factors, no weights explain all
// three.
TEST(PixelObserver, ExplainColorsUpToTheirLimits) {
  const Explained found = explain_random(613, 60, colorful);
  EXPECT_GT(found.merged, 250);
  EXPECT_LT(found.farthest, 2 * kOfMerged);
  EXPECT_LT(found.sum_of_errors / (3 * found.pixels), kOfSums / 2);
}

// Three strips with two slots: the two left ones become one. A third of the pixel each, or what a surface in front of
// the merged one leaves of it.
TEST(PixelObserver, WhatIsLeftOfAMergedOwnerIsSharedByItsTriangles) {
  SetupTriangles triangles = triangles_of({left_of(64, -0.5f), right_of(192, -0.49f), everywhere(-0.2f)});
  const std::vector<glm::vec3> colors{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  OpenTile<8, 2> tile(triangles, colors);
  const PixelObservers observers = observers_of(1, tile.positions);
  tile.observers = &observers;
  tile.compose({0, 1, 2});
  ASSERT_EQ(tile.merges[0], 1);
  std::vector<double> found(3);
  for (const SurfaceWeight& each : observers[0]->history.weights()) {
    found[each.triangle] = each.weight;
    EXPECT_EQ(each.order, each.triangle + 1);
    EXPECT_FALSE(each.tiny);
  }
  EXPECT_NEAR(found[0], 0.25, 1e-3);
  EXPECT_NEAR(found[1], 0.25, 1e-3);
  EXPECT_NEAR(found[2], 0.5, 1e-3);
}

Fragment fragment_with(std::uint32_t triangle, std::uint32_t mask, float area) {
  Fragment fragment{};
  fragment.triangle = triangle, fragment.alpha = area, fragment.color = glm::vec3(static_cast<float>(triangle)) * area;
  fragment.mask.words[0] = mask;
  return fragment;
}
WideMask word(std::uint32_t mask) { return fragment_with(0, mask, 0).mask; }

TEST(PixelObserver, PositionsMoveBetweenFragments) {
  PixelObserver observer;
  observer.add_positions(std::vector<glm::vec2>(32));
  observer.arrives(fragment_with(7, 0xff, 0.25f), word(0xff));
  observer.arrives(fragment_with(9, 0xf0f0, 0.25f), word(0xf0f0));
  observer.arrives(fragment_with(3, 0xf, 0.1f), {});
  observer.would_cover(11, 0, 0xff);
  const std::vector<HistoryFragment>& fragments = observer.history.fragments;
  ASSERT_EQ(fragments.size(), 4u);
  EXPECT_EQ(fragments[0].lost.at(0).fragment, 1u);
  EXPECT_EQ(fragments[0].lost.at(0).positions, 4u);
  EXPECT_EQ(fragments[1].taken.size(), 2u) << "from #0, and empty ones";
  EXPECT_EQ(fragments[2].fate, Fate::hidden);
  EXPECT_EQ(fragments[3].fate, Fate::closed_off);
  EXPECT_EQ(fragments[3].lost.size(), 2u);
}

TEST(PixelObserver, FactorsOfAggregatesMultiply) {
  PixelObserver observer;
  const Aggregate any = kEmptyAggregate;
  observer.enters(0, fragment_with(1, 0, 0.5f));
  observer.enters(1, fragment_with(2, 0, 0.5f));
  observer.joins(0, {any, any, any, 0.5f, 1.0f});
  observer.enters(1, fragment_with(4, 0, 1.0f));
  observer.joins(0, {any, any, any, 0.5f, 0.25f});
  observer.finishes_aggregate();
  EXPECT_EQ(observer.history.sum().x, 0.125 * 1 + 0.25 * 2 + 0.25 * 4);
}

TEST(PixelObserver, LayersTakeTheirPartOfASample) {
  PixelObserver observer;
  observer.add_positions(std::vector<glm::vec2>(4));
  observer.contends(5, 0, 0xf, 0xf);
  observer.blends(6, 1, 0.5, glm::dvec3(2));
  observer.blends(8, 1, 0.5, glm::dvec3(4));
  observer.adds_samples(5, 0, 4, 0.25, glm::dvec3(1));
  EXPECT_EQ(observer.history.sum().x, 0.25 * (3 + 0.25 * 1 + 0.25 * 2 + 0.5 * 4));
  observer.contends(9, 0, 0x2, 0x2);
  EXPECT_EQ(observer.seen_behind_layers(1), 1) << "an opaque surface hides the layers";
}

}  // namespace beampipe::pixel_observer_test
