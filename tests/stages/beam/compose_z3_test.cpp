#include "stages/beam/compose_z3.h"

#include "tests/stages/beam_pixels.h"

namespace beampipe::compose_z3_test {

template <std::size_t Words>
std::vector<Z3Pixel<Words>> composed(const SetupTriangles& triangles, const std::vector<glm::vec3>& colors,
                                     const Tile& tile) {
  const PositionSet positions(cell_patterns(32 * Words));
  StageCounters counters;
  std::vector<Fragment> fragments =
      fragments_of(triangles, tile, {.mask = MaskSource::exact, .positions = positions.patterns, .fragment_bytes = 26});
  shade(colors, fragments, counters);
  std::vector<Z3Pixel<Words>> pixels(tile.pixels());
  std::vector<float> merges(tile.pixels());
  compose_z3(fragments, positions, counters, pixels, merges);
  return pixels;
}

const Tile kPixel{0, 0, 1, 1};

TEST(ComposeZ3, LayersThatFitAreWeightedByTheirPositions) {
  SetupTriangles triangles = triangles_of({everywhere(-0.5f), left_of(64, -0.75f), right_of(192, -0.6f)});
  const PixelColor found = z3_colors(composed<4>(triangles, {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, kPixel)).at(0);
  EXPECT_EQ(found.alpha, 1.0f);
  EXPECT_EQ(found.color, glm::vec3(0.5f, 0.25f, 0.25f));
}

TEST(ComposeZ3, OrderDoesNotMatterWhileLayersFit) {
  for (const bool front_first : {true, false}) {
    SetupTriangles triangles;
    if (front_first) add_triangle(triangles, left_of(128, -0.75f));
    add_triangle(triangles, everywhere(-0.5f));
    if (!front_first) add_triangle(triangles, left_of(128, -0.75f));
    std::vector<glm::vec3> colors = {{1, 0, 0}, {0, 1, 0}};
    if (!front_first) std::swap(colors[0], colors[1]);
    EXPECT_EQ(z3_colors(composed<1>(triangles, colors, kPixel)).at(0).color, glm::vec3(0.5f, 0.5f, 0)) << front_first;
  }
}

TEST(ComposeZ3, TheClosestTwoAreMerged) {
  // Four strips next to each other. The two that are closest in depth are merged.
  SetupTriangles triangles =
      triangles_of({everywhere(-0.4f), left_of(192, -0.41f), left_of(64, -0.9f), left_of(32, -0.95f)});
  const std::vector<glm::vec3> colors = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 1}};
  const auto pixels = composed<1>(triangles, colors, kPixel);
  const PixelColor before = z3_colors(pixels).at(0);
  EXPECT_NEAR(before.color.r, 0.25, 1e-3);
  EXPECT_NEAR(before.color.g, 0.5, 1e-3);
  EXPECT_NEAR(before.color.b, 0.25, 1e-3);
  EXPECT_NEAR(pixels[0].layers[0].z, -0.4 - 0.01 * 2 / 3, 1e-4);  // 16 and 8 positions
}

TEST(ComposeZ3, WeightsNeverPassOne) {
  Random random(91);
  const SetupTriangles triangles = random_triangles(random, 80);
  const std::vector<glm::vec3> white(triangles.triangles.size(), glm::vec3(1.0f));
  for (const PixelColor& pixel : z3_colors(composed<1>(triangles, white, {0, 0, 12, 12}))) {
    EXPECT_GE(pixel.alpha, 0.0f);
    EXPECT_LE(pixel.alpha, 1.0f);
    EXPECT_NEAR(pixel.color.r, pixel.alpha, 2e-3);  // fp16
  }
}

}  // namespace beampipe::compose_z3_test
