// Properties that a pixel in near-first order has, whatever is composed into it. BEAMPIPE_THOROUGH=N tries N times as
// many cases.
#include <cstdio>

#include "stages/beam/owner_rules.h"
#include "tests/stages/open_pixels.h"
#include "tests/stages/search.h"

namespace beampipe::compose_pooled_properties_test {

constexpr Tile kTile{0, 0, 12, 10};
constexpr float kLeast = 0.125f, kGreatest = 0.75f;  // of the colours

struct Composed {
  std::uint64_t fragments = 0, merges = 0, requests = 0;
};

// The area is at most the tolerance away from the number of positions that a fragment covers, and 1 if these are all. A
// colour lies between the least and the greatest one of the triangles, up to the tolerances of the estimate.
template <std::size_t Words, std::size_t Slots>
void compose_random(const SetupTriangles& triangles, const std::vector<glm::vec3>& colors, const TriangleList& list,
                    const std::vector<float>* watermarks, const ChunkPool& pool, Composed& composed) {
  OpenTile<Words, Slots> tile(triangles, colors, kTile, pool);
  const std::vector<PixelColor> found = tile.compose(list, watermarks);
  std::vector<WideMask> covered(kTile.pixels());
  std::vector<bool> has_specks(kTile.pixels());
  for (const Fragment& fragment : tile.fragments) {
    covered[fragment.pixel] = covered[fragment.pixel] | fragment.mask;
    if (fragment.mask.none()) has_specks[fragment.pixel] = true;
  }
  constexpr double kPositions = 32.0 * Words, kRounding = 1e-4;  // three units of FixedSum
  for (std::size_t i = 0; i < found.size(); ++i) {
    const PixelColor& pixel = found[i];
    const double count = static_cast<double>(covered[i].count());
    ASSERT_GE(pixel.alpha, 0.0f);
    ASSERT_LE(pixel.alpha, 1.0f);
    if (count == kPositions) {
      ASSERT_EQ(pixel.alpha, 1.0f) << "pixel " << i;
    }
    ASSERT_NEAR(pixel.alpha * kPositions, count, kAreaTolerance + kRounding * kPositions) << "pixel " << i;
    if (count == 0 && !has_specks[i]) {
      ASSERT_EQ(pixel.alpha, 0.0f) << "pixel " << i;
    }
    const double tolerance = (kAreaTolerance + kColorTolerance) / kPositions * kGreatest + kRounding;
    for (int c = 0; c < 3; ++c) {
      ASSERT_GE(pixel.color[c], 0.0f);
      ASSERT_GE(pixel.color[c], kLeast * pixel.alpha - tolerance) << "pixel " << i;
      ASSERT_LE(pixel.color[c], kGreatest * pixel.alpha + kRounding) << "pixel " << i;
    }
  }
  composed.fragments += tile.fragments.size();
  for (const float merges : tile.merges) composed.merges += static_cast<std::uint64_t>(merges);
  composed.requests += tile.result.spills.all();
}

TEST(Properties, NearFirstKeepsAreaAndColour) {
  Composed composed;
  search(7'000'000, 40, [&](Random& random) {
    const SetupTriangles triangles = random_triangles(random, random.int32(1, 160));
    const std::vector<glm::vec3> colors = random_colors(triangles, random, kLeast, kGreatest);
    StageCounters ignored;
    const OrderedList ordered = bin_sort(triangles, all_of(triangles), kTile, ignored);
    const std::vector<float>* watermarks = random.one_in(4) ? nullptr : &ordered.watermarks;
    constexpr int kMostBytes = 60 * 12 * 10;  // 60 a pixel, which some bins fill
    const ChunkPool pool(random.one_in(4) ? 1 << 20 : static_cast<std::size_t>(random.integer(0, kMostBytes)));
    const auto compose = [&]<std::size_t Words, std::size_t Slots>() {
      ASSERT_NO_FATAL_FAILURE(
          (compose_random<Words, Slots>(triangles, colors, ordered.triangles, watermarks, pool, composed)));
    };
    compose.template operator()<8, 5>();
    compose.template operator()<4, 7>();
    compose.template operator()<2, 4>();
    compose.template operator()<1, 2>();
  });
  const auto count = [](std::uint64_t value) { return static_cast<unsigned long long>(value); };
  std::printf("fragments composed: %llu; owners that became one: %llu; requests of chunks in memory: %llu\n",
              count(composed.fragments), count(composed.merges), count(composed.requests));
  EXPECT_GT(composed.merges, composed.fragments / 100);
  EXPECT_GT(composed.requests, composed.fragments / 100);
}

// Bit planes say of every position the state that it has, and are taken apart into the positions they were made from.
TEST(ComposePooledProperties, BitPlanesAreThePositionsOfEachState) {
  Random random(7);
  for (std::size_t count = 1; count <= kMostStates; ++count) {
    std::array<WideMask, kMostStates> states{}, found{};
    std::array<std::size_t, 256> state_of{};
    for (std::size_t i = 0; i < state_of.size(); ++i) {
      state_of[i] = static_cast<std::size_t>(random.integer(0, static_cast<int>(count) - 1));
      states[state_of[i]].set(i);
    }
    std::vector<WideMask> planes;
    for (std::size_t p = 0; p < planes_for(count); ++p) planes.push_back(join_states(p, count, {}, states.data()));
    for (std::size_t i = 0; i < state_of.size(); ++i)
      for (std::size_t p = 0; p < planes.size(); ++p) ASSERT_EQ(planes[p].test(i), (state_of[i] >> p & 1) != 0);
    split_states(
        planes.size(), first_words(8), [&](std::size_t p) { return planes[p]; }, found.data());
    ASSERT_EQ(found, states) << count << " states";
  }
}

}  // namespace beampipe::compose_pooled_properties_test
