#include "stages/beam/beam_fragment.h"

#include "tests/stages/beam_pixels.h"

namespace beampipe::beam_fragment_test {

constexpr Tile kPixel{0, 0, 1, 1};
constexpr MaskSource kBoth[] = {MaskSource::table, MaskSource::exact};

// The left quarter of the pixel contains columns 0..7 of the Hammersley pattern, whose bits are sorted by x.
TEST(BeamFragment, OneEdge) {
  SetupTriangles triangles = triangles_of({{{64, -5'000}, {64, 5'000}, {-5'000, 0}}});
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
  SetupTriangles triangles =
      triangles_of({{{-5'000, -5'000, -0.75f}, {20'000, -5'000, -0.75f}, {-5'000, 20'000, -0.25f}}});
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
  SetupTriangles triangles = triangles_of({{{7, 29}, {10, 30}, {7, 31}}});
  for (const MaskSource source : kBoth) {
    const Fragments fragments = beam_fragments(triangles, kPixel, source);
    ASSERT_EQ(fragments.list.size(), 1u);
    EXPECT_TRUE(fragments.list[0].tiny);
    EXPECT_EQ(fragments.list[0].mask.words[0], 1u);
    EXPECT_NEAR(fragments.list[0].alpha, 3.0 / 65536, 5e-7);  // 3 x 2 / 2 units
    EXPECT_NEAR(fragments.list[0].centroid_u, 8.0 / 256, 1.0 / 65536);
  }
}

// A speck gets the nearest positions, as many as its area fills, but no more than are allowed.
TEST(BeamFragment, TinyTrianglesAreGivenTheNearestPositions) {
  Random random(135);
  const SamplePattern pattern = hammersley_pattern();
  const SetupTriangles triangles = random_triangles(random, 3'000);
  for (const int most : {1, 3}) {
    std::array<int, 4> given{};
    for (const Fragment& fragment : beam_fragments(triangles, {0, 0, 12, 12}, MaskSource::exact, most).list) {
      const std::uint32_t mask = fragment.mask.words[0];
      ASSERT_NE(mask, 0u);
      if (!fragment.tiny) continue;
      ASSERT_EQ(std::popcount(mask), std::min(most, static_cast<int>(std::ceil(fragment.alpha * 32))));
      ++given[static_cast<std::size_t>(std::popcount(mask))];
      double farthest_given = 0, nearest_other = 2;
      for (std::size_t s = 0; s < 32; ++s) {
        const double distance =
            std::hypot(pattern.x[s] / 256.0 - fragment.centroid_u, pattern.y[s] / 256.0 - fragment.centroid_v);
        double& of = mask >> s & 1 ? farthest_given : nearest_other;
        of = mask >> s & 1 ? std::max(of, distance) : std::min(of, distance);
      }
      ASSERT_LE(farthest_given, nearest_other + 1e-6);
    }
    for (int count = 1; count <= most; ++count) EXPECT_GT(given[static_cast<std::size_t>(count)], 5) << count;
  }
}

// The triangle fills the lower right quarter of four pixels and only touches the others along its borders.
TEST(BeamFragment, TouchedPixelsWithoutAreaAreDroppedAndCounted) {
  SetupTriangles triangles = triangles_of({{{256, 256}, {512, 256}, {256, 512}}});
  const Fragments fragments = beam_fragments(triangles, {0, 0, 4, 4}, MaskSource::table);
  ASSERT_EQ(fragments.list.size(), 1u);
  EXPECT_EQ(fragments.list[0].pixel, 1u * 4 + 1);
  EXPECT_EQ(fragments.list[0].alpha, 0.5f);
  // All of the pixels 0..2 in x and y, except (2, 2), which it does not touch.
  EXPECT_EQ(fragments.counters.items_in, 8u);
  EXPECT_EQ(fragments.counters.items_out, 1u);
}

}  // namespace beampipe::beam_fragment_test
