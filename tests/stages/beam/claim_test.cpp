#include "stages/beam/claim.h"

#include <gtest/gtest.h>

#include <set>

#include "stages/beam/beam_fragment.h"
#include "stages/beam/settle.h"
#include "stages/cost/plane_cost.h"
#include "stages/picture/shade.h"
#include "stages/raster/conservative_raster.h"
#include "tests/simd/random.h"
#include "tests/stages/screen_triangles.h"

namespace beampipe {
namespace {

const Tile kPixel{0, 0, 1, 1};

// Runs a tile in streaming order, pass by pass.
template <std::size_t Words, std::size_t Layers>
struct Stream {
  using Pixel = OwnerPixel<Words, Layers>;
  const SetupTriangles& triangles;
  Tile tile;
  PositionSet positions{cell_patterns(32 * Words)};
  StageCounters counters;
  std::vector<Pixel> pixels;
  std::vector<Fragment> fragments;

  Stream(const SetupTriangles& of, const Tile& in)
      : triangles(of), tile(in), pixels(tile.pixels(), cleared_pixel<Words, Layers>()) {
    std::vector<Pair> pairs;
    conservative_raster(triangles, all_of(triangles), tile, counters, pairs);
    fragments = fragments_of(pairs);
  }

  std::vector<Fragment> fragments_of(const std::vector<Pair>& pairs) {
    std::vector<Fragment> made;
    beam_fragment(triangles, pairs, tile, {MaskSource::exact, positions.patterns, nullptr, nullptr, 66, 0}, counters,
                  made);
    return made;
  }
  void claim_all() {
    std::vector<Fragment> wanted = fragments;
    std::erase_if(wanted, [&](const Fragment& fragment) { return !is_unfinished(pixels[fragment.pixel]); });
    claim(triangles, wanted, tile, positions, counters, pixels);
  }
  void settle_all(const std::vector<glm::vec3>& colors, bool last = false) {
    std::vector<Fragment> seen = fragments_of(owners(triangles, pixels, tile, counters));
    shade_visible(colors, seen, counters);
    settle(seen, last, counters, pixels);
  }
  bool finished() const {
    return std::none_of(pixels.begin(), pixels.end(), [](const Pixel& pixel) { return is_unfinished(pixel); });
  }
  int run(const std::vector<glm::vec3>& colors) {  // returns the number of passes
    int passes = 0;
    for (; !finished(); ++passes) claim_all(), settle_all(colors);
    return passes;
  }
};

std::vector<glm::vec3> random_colors(const SetupTriangles& triangles, Random& random) {
  std::vector<glm::vec3> colors;
  for (std::size_t i = 0; i < triangles.triangles.size(); ++i)
    colors.emplace_back(random.real32(0, 1), random.real32(0, 1), random.real32(0, 1));
  return colors;
}

// A position that is settled, in any pass, belongs to the nearest triangle, and to the earlier one among equal depths.
// Every covered position is settled once, and other positions never have an owner.
template <std::size_t Words, std::size_t Layers>
void expect_nearest_owners(std::int64_t seed) {
  Random random(seed);
  SCOPED_TRACE(random.name());
  SetupTriangles triangles = random_triangles(random, 60);
  for (int i = 0; i < 5; ++i) {  // duplicates: equal depth
    triangles.triangles.push_back(triangles.triangles[static_cast<std::size_t>(i * 7)]);
    triangles.attributes.push_back(triangles.attributes[0]);
  }
  const std::vector<glm::vec3> colors = random_colors(triangles, random);
  Stream<Words, Layers> stream{triangles, {0, 0, 12, 12}};
  using Pixel = OwnerPixel<Words, Layers>;

  constexpr std::size_t kPositions = 32 * Words;
  std::vector<std::uint32_t> nearest(144 * kPositions, ~0u);
  std::vector<float> depth(144 * kPositions, kNoDepth);
  for (const Fragment& fragment : stream.fragments)
    for (std::size_t p = 0; p < kPositions; ++p) {
      if (!fragment.mask.test(p)) continue;
      const SamplePattern& pattern = stream.positions.patterns[p / 32];
      const float z = depth_at(fragment.plane, position_u(pattern, p % 32), position_v(pattern, p % 32));
      const std::size_t at = fragment.pixel * kPositions + p;
      if (z < depth[at]) depth[at] = z, nearest[at] = fragment.triangle;
    }
  std::vector<int> settled(144 * kPositions);
  for (int pass = 0; !stream.finished(); ++pass) {
    ASSERT_LT(pass, 70);
    stream.claim_all();
    for (std::size_t pixel = 0; pixel < 144; ++pixel)
      for (std::uint32_t k = 0; k < Layers; ++k) {
        const WideMask owned = stream.pixels[pixel].positions_in(Pixel::kFirstLayer + k);
        for (std::size_t p = 0; p < kPositions; ++p) {
          if (!owned.test(p)) continue;
          ASSERT_EQ(stream.pixels[pixel].triangle(k), nearest[pixel * kPositions + p]) << pixel << " " << p;
          ++settled[pixel * kPositions + p];
        }
      }
    stream.settle_all(colors);
  }
  for (std::size_t at = 0; at < settled.size(); ++at) ASSERT_EQ(settled[at], nearest[at] == ~0u ? 0 : 1) << at;
}

TEST(Claim, EveryPositionIsSettledOnceForItsNearestTriangle) {
  for (const std::int64_t seed : {81, 82, 83}) {
    expect_nearest_owners<1, 1>(seed);
    expect_nearest_owners<1, 5>(seed);
    expect_nearest_owners<2, 1>(seed);
    expect_nearest_owners<4, 5>(seed);
    expect_nearest_owners<8, 1>(seed);
  }
}

TEST(Claim, AnEdgeOverASurfaceSplitsThePixel) {
  SetupTriangles triangles;
  add_left_of(triangles, 77, -0.75f);  // the left 77/256 of the pixel
  add_everywhere(triangles, -0.5f);
  Stream<1, 5> stream{triangles, kPixel};
  EXPECT_EQ(stream.run({{1, 0, 0}, {0, 1, 0}}), 1);
  const PixelColor found = settled_colors(stream.pixels).at(0);
  EXPECT_EQ(found.alpha, 1.0f);
  EXPECT_NEAR(found.color.r, 77.0 / 256, 1.0 / 4096);  // fp16
  EXPECT_NEAR(found.color.g, 179.0 / 256, 1.0 / 4096);
}

TEST(Claim, SurfacesInAnyOrderOverTheWholePixelTakeOnePass) {
  // 60 triangles that cover everything. The nearest one hides the others, so one layer is enough.
  for (const bool back_to_front : {true, false}) {
    SetupTriangles triangles;
    for (int i = 0; i < 60; ++i)
      add_everywhere(triangles, -0.2f + (back_to_front ? -0.01f : 0.01f) * static_cast<float>(i) * 0.3f);
    std::vector<glm::vec3> colors(60, glm::vec3(0, 0, 1));
    colors[back_to_front ? 59 : 0] = {1, 0, 0};
    Stream<2, 1> stream{triangles, kPixel};
    EXPECT_EQ(stream.run(colors), 1);
    EXPECT_EQ(settled_colors(stream.pixels).at(0).color, glm::vec3(1, 0, 0));
  }
}

TEST(Claim, MoreVisibleSurfacesThanLayersTakeMorePasses) {
  // With eleven upright strips, five layers need three passes, and one layer needs eleven. Their order does not matter.
  constexpr double kColumn = 1.0 / 64;  // a partly hidden strip is only known to one column of positions
  for (const int first : {0, 4, 7}) {
    SetupTriangles triangles;
    std::vector<glm::vec3> colors;
    for (int i = 0; i < 11; ++i) {
      const int strip = (first + 3 * i) % 11;
      add_left_of(triangles, 23 * (strip + 1) + 2, -0.9f + 0.05f * static_cast<float>(strip));
      colors.emplace_back(strip == 3, 0, 0);
    }
    Stream<8, 5> five{triangles, kPixel};
    Stream<8, 1> one{triangles, kPixel};
    EXPECT_EQ(five.run(colors), 3);
    EXPECT_EQ(one.run(colors), 11);
    EXPECT_NEAR(settled_colors(five.pixels).at(0).color.r, 23.0 / 256, kColumn);
    EXPECT_NEAR(settled_colors(one.pixels).at(0).color.r, 23.0 / 256, kColumn);
  }
}

TEST(Claim, ManyPassesKeepAConstantColour) {
  SetupTriangles triangles;
  for (int i = 0; i < 16; ++i) add_left_of(triangles, 16 * (i + 1), -0.9f + 0.05f * static_cast<float>(i));
  const float tone = HalfBits(0.7f);
  Stream<8, 1> stream{triangles, kPixel};
  EXPECT_EQ(stream.run(std::vector<glm::vec3>(16, glm::vec3(0.7f))), 16);
  EXPECT_EQ(settled_colors(stream.pixels).at(0).color, glm::vec3(tone));
}

TEST(Claim, TheLastPassGivesWhatIsUndecidedToTheRest) {
  SetupTriangles triangles;
  add_left_of(triangles, 128, -0.9f);
  add_everywhere(triangles, -0.5f);
  Stream<1, 1> stream{triangles, kPixel};
  stream.claim_all();
  stream.settle_all({{1, 0, 0}, {0, 1, 0}}, true);
  EXPECT_TRUE(stream.finished());
  EXPECT_EQ(settled_colors(stream.pixels).at(0).color, glm::vec3(1, 0, 0));
  EXPECT_EQ(settled_colors(stream.pixels).at(0).alpha, 1.0f);
}

TEST(Claim, SpecksMakeAreasCountByPositions) {
  // A triangle that covers one position of 32 counts with its own area. With a speck in the pixel, it counts as 1/32.
  SetupTriangles triangles;
  const SamplePattern pattern = cell_patterns(32)[0];
  const std::int32_t x = pattern.x[5], y = pattern.y[5];
  add_triangle(triangles, {x - 30, y - 20}, {x + 30, y - 20}, {x, y + 30});
  Stream<1, 5> alone{triangles, kPixel};
  ASSERT_EQ(alone.fragments.at(0).mask.count(), 1);
  alone.run({{1, 1, 1}});
  EXPECT_NEAR(settled_colors(alone.pixels).at(0).alpha, alone.fragments[0].alpha, 1e-5);
  EXPECT_GT(std::abs(alone.fragments[0].alpha - 1.0 / 32), 1e-3);
  add_triangle(triangles, {x + 34, y - 20}, {x + 36, y - 20}, {x + 36, y - 16});
  Stream<1, 5> beside{triangles, kPixel};
  ASSERT_EQ(beside.fragments.at(1).mask.count(), 0);
  beside.run({{1, 1, 1}, {1, 1, 1}});
  EXPECT_NEAR(settled_colors(beside.pixels).at(0).alpha, 1.0 / 32, 1e-5);
}

TEST(Claim, ASpeckShowsUnlessWhatLiesThereIsSettledOrNearer) {
  SetupTriangles triangles;
  add_everywhere(triangles, -0.5f);
  const PositionSet positions(cell_patterns(32));
  using Pixel = OwnerPixel<1, 5>;
  const auto shows = [&](std::uint32_t state, float z) {
    std::vector<Pixel> pixels = {cleared_pixel<1, 5>()};
    WideMask all;
    all.words[0] = ~0u;
    pixels[0].put(all, state);
    if (state == Pixel::kFirstLayer) pixels[0].set_triangle(0, 0);
    Fragment speck{};
    speck.centroid_u = 0.3f, speck.centroid_v = 0.6f, speck.centroid_z = z;
    StageCounters counters;
    claim(triangles, {speck}, kPixel, positions, counters, pixels);
    return (pixels[0].owner[0] & Pixel::kSpeck) != 0;
  };
  EXPECT_TRUE(shows(Pixel::kEmpty, -0.25f));
  EXPECT_TRUE(shows(Pixel::kDeferred, -0.25f));
  EXPECT_FALSE(shows(Pixel::kSettled, -0.75f));
  EXPECT_TRUE(shows(Pixel::kFirstLayer, -0.75f));
  EXPECT_FALSE(shows(Pixel::kFirstLayer, -0.25f));
}

TEST(Claim, CountsWhatItReadsAndWrites) {
  SetupTriangles triangles;
  add_everywhere(triangles, -0.5f);
  add_everywhere(triangles, -0.4f);  // hidden
  Stream<4, 5> stream{triangles, kPixel};
  stream.counters = {};
  stream.claim_all();
  EXPECT_EQ(stream.counters.items_in, 2u);
  EXPECT_EQ(stream.counters.items_out, 1u);
  EXPECT_EQ(stream.counters.bytes_read, 2 * (40u + 80u) + 40u);  // two fragments, two states, one owner's plane
  EXPECT_EQ(stream.counters.bytes_written, 80u);
}

TEST(Settle, CountsItsArithmetic) {
  SetupTriangles triangles;
  add_everywhere(triangles, -0.5f);
  Stream<4, 5> stream{triangles, kPixel};
  stream.claim_all();
  StageCounters finding;
  std::vector<Fragment> seen = stream.fragments_of(owners(triangles, stream.pixels, kPixel, finding));
  ASSERT_EQ(seen.size(), 1u);
  // For four words: to find states 1 to 5 of three bits takes two ands each, and eight inversions in all. Then the
  // owner's plane and its depth bounds in the pixel (stages/data/pixel_depth.h).
  OperationCounts search{0, 0, 4 * (5 * 2 + 8), 0, 0, 0};
  search += pair_bounds_cost();
  search += vertex_bounds_cost();
  EXPECT_EQ(finding.ops, search);
  EXPECT_EQ(finding.bytes_read, 80u);
  EXPECT_EQ(finding.bytes_written, 16u);
  StageCounters counters;
  settle(seen, true, counters, stream.pixels);
  EXPECT_EQ(counters.items_in, 1u);
  EXPECT_EQ(counters.items_out, 0u) << "it is the last pass";
  // For four words: to find states 1 to 7 of three bits (two ands each, and nine inversions in all), to put two states
  // (three and six operations), to join the owners' positions, and to take away what is deferred.
  OperationCounts all{0, 0, 4 * (7 * 2 + 9 + 3 + 6 + 7), 0, 0, 0};
  // A population count of four words. Area and colour are converted from their formats, multiplied by the area, scaled,
  // divided and converted back.
  all += OperationCounts{3 + 1 + 1, 3 + 1 + 1, 4, 0, 1 + 3, 4 + 1 + 3 + 3 + 1};
  // The pixel is finished: empty positions are found and joined, then two counts and the scale.
  all += OperationCounts{0, 6 + 5, 4 * (3 + 2 + 2) + 8, 0, 2, 8};
  // The owner: two more counts, its visible part, its area (simd/conserve.h), and what it adds to area, positions and
  // colour.
  all += OperationCounts{3 + 3 + 1, 6 + 12 + 2 + 3 + 1, 8, 0, 1 + 5 + 1, 8};
  EXPECT_EQ(counters.ops, all);
  EXPECT_EQ(counters.lanes_used, 1u);
  EXPECT_EQ(counters.lanes_issued, 1u);
  EXPECT_EQ(counters.bytes_read, 80u + 40u) << "the pixel and the fragment";
  EXPECT_EQ(counters.bytes_written, 80u);
}

}  // namespace
}  // namespace beampipe
