#include "stages/beam/compose_beam.h"

#include <numbers>

#include "simd/conserve.h"
#include "stages/data/position_set.h"
#include "tests/stages/beam_pixels.h"

namespace beampipe::compose_beam_test {

const Tile kPixel{0, 0, 1, 1};

template <std::size_t Words>
std::vector<PixelColor> composed_as(const SetupTriangles& triangles, const std::vector<glm::vec3>& colors,
                                    const Tile& tile, std::vector<float>* largest) {
  const auto [pixels, windows] = compose_windows<Words>(triangles, colors, tile, [](const auto&...) {});
  if (largest) *largest = windows;
  return composed_colors(pixels);
}

std::vector<PixelColor> composed(const SetupTriangles& triangles, const std::vector<glm::vec3>& colors,
                                 const Tile& tile, int bits, std::vector<float>* largest = nullptr) {
  if (bits == 32) return composed_as<1>(triangles, colors, tile, largest);
  return composed_as<8>(triangles, colors, tile, largest);
}

TEST(VisibleArea, TheBackgroundGetsWhatIsLeft) {
  // 100 of 256 positions are taken. The area is not a multiple of 1/256.
  const Taken<float> taken{0.4f, 100};
  EXPECT_NEAR(visible_area(1.0f, 256.0f, 156.0f, 256.0f, taken), 0.6f, 1e-6);
}

TEST(VisibleArea, AWholeFragmentHasItsOwnArea) {
  EXPECT_NEAR(visible_area(0.3f, 70.0f, 70.0f, 256.0f, Taken<float>{0.4f, 100}), 0.3f, 1e-6);
  EXPECT_NEAR(visible_area(0.7f, 170.0f, 170.0f, 256.0f, Taken<float>{0.4f, 86}), 0.6f, 1e-6);  // at most the free area
}

TEST(VisibleArea, APartOfAFragmentBringsPartOfTheErrorsAlong) {
  // Half of it is visible: 56 / 256, plus a quarter of 1/16, by which its area exceeds that of its 112 positions.
  EXPECT_NEAR(visible_area(0.5f, 112.0f, 56.0f, 256.0f, Taken<float>{0.25f, 64}), 0.234375f, 1e-6);
  // The surfaces in front took 0.05 more than their 64 positions. This fragment owns 56 of the 192 remaining positions
  // and gives up the same share of the 0.05.
  EXPECT_NEAR(visible_area(0.5f, 112.0f, 56.0f, 256.0f, Taken<float>{0.3f, 64}), 0.2197917f, 1e-6);
}

TEST(VisibleArea, StaysBetweenNothingAndWhatIsFree) {
  Random random(71);
  for (int i = 0; i < 100000; ++i) {
    const float covered = static_cast<float>(random.integer(1, 256));
    const float visible = static_cast<float>(random.integer(0, static_cast<int>(covered)));
    const float taken = static_cast<float>(random.integer(0, 256 - static_cast<int>(visible)));
    const auto area = static_cast<float>(random.real(0, 1)), before = static_cast<float>(random.real(0, 1));
    const float found = visible_area(area, covered, visible, 256.0f, Taken<float>{before, taken});
    ASSERT_GE(found, 0.0f);
    ASSERT_LE(found, std::min(area, 1.0f - before));
  }
}

TEST(ComposeWindow, AnEdgeOverASurfaceSplitsThePixelExactly) {
  for (const int bits : {32, 256}) {
    SetupTriangles triangles = triangles_of({left_of(77, -0.75f),  // the left 77/256 of the pixel
                                             everywhere(-0.5f)});
    const PixelColor found = composed(triangles, {{1, 0, 0}, {0, 1, 0}}, kPixel, bits).at(0);
    EXPECT_NEAR(found.alpha, 1.0, 1e-6);
    EXPECT_NEAR(found.color.r, 77.0 / 256, 1e-6) << bits;
    EXPECT_NEAR(found.color.g, 179.0 / 256, 1e-6) << bits;
  }
}

TEST(ComposeWindow, ColorIsStoredAsHalfBehindEveryWindow) {
  SetupTriangles triangles = triangles_of({left_of(77, -0.75f), everywhere(-0.5f)});
  const std::vector<glm::vec3> colors = {{0.7f, 0, 0}, {0.1f, 0, 0}};
  const float first = HalfBits(77.0f / 256 * 0.7f);
  EXPECT_EQ(composed(triangles, colors, kPixel, 256).at(0).color.r, HalfBits(first + 179.0f / 256 * 0.1f));
}

TEST(ComposeWindow, ASurfaceOfManyTrianglesHidesWhatIsBehind) {
  // A fan of 64 triangles around the pixel's centre closes it. Behind it is another colour, which must not show at all.
  SetupTriangles triangles;
  std::vector<glm::vec3> colors;
  std::vector<ScreenPoint> rim;
  for (int i = 0; i < 16; ++i) rim.push_back({i * 16, 0, -0.75f});
  for (int i = 0; i < 16; ++i) rim.push_back({256, i * 16, -0.75f});
  for (int i = 0; i < 16; ++i) rim.push_back({256 - i * 16, 256, -0.75f});
  for (int i = 0; i < 16; ++i) rim.push_back({0, 256 - i * 16, -0.75f});
  for (std::size_t i = 0; i < rim.size(); ++i) {
    add_triangle(triangles, {128, 120, -0.75f}, rim[i], rim[(i + 1) % rim.size()]);
    colors.emplace_back(1, 0, 0);
  }
  add_triangle(triangles, everywhere(-0.5f));
  colors.emplace_back(0, 1, 0);
  const PixelColor found = composed(triangles, colors, kPixel, 256).at(0);
  EXPECT_NEAR(found.color.r, 1.0, 2e-6);
  EXPECT_NEAR(found.color.g, 0.0, 2e-6);
}

// A disc with a radius of 2 pixels is cut into triangles that are far smaller than the mask's cells. All lie in one
// plane, which is flat or tilted. The visible area in all pixels together must be the disc's area.
TEST(ComposeWindow, ADenseMeshKeepsItsSilhouette) {
  constexpr int kRings = 60, kSectors = 240;
  const Tile tile{0, 0, 8, 8};
  for (const float tilt : {0.0f, 2e-4f}) {
    SetupTriangles triangles;
    const auto at = [&](int ring, int sector) {
      const double radius = 512.0 * ring / kRings, angle = 2 * std::numbers::pi * sector / kSectors;
      const auto x = static_cast<std::int32_t>(std::lround(1024 + radius * std::cos(angle)));
      const auto y = static_cast<std::int32_t>(std::lround(1024 + radius * std::sin(angle)));
      return ScreenPoint{x, y, -0.5f + tilt * static_cast<float>(x)};
    };
    double area = 0;  // in pixels
    for (int ring = 0; ring < kRings; ++ring)
      for (int sector = 0; sector < kSectors; ++sector) {
        const ScreenPoint p = at(ring, sector), q = at(ring + 1, sector), r = at(ring + 1, sector + 1),
                          s = at(ring, sector + 1);
        for (const auto& [a, b, c] : {std::array{p, q, r}, std::array{p, r, s}}) {
          if (twice_area(a, b, c) == 0) continue;
          area += std::abs(static_cast<double>(twice_area(a, b, c))) / 131072.0;
          add_triangle(triangles, a, b, c);
        }
      }
    double seen = 0;
    for (const PixelColor& pixel :
         composed(triangles, std::vector<glm::vec3>(triangles.triangles.size(), glm::vec3(1)), tile, 256))
      seen += pixel.color.r;
    EXPECT_NEAR(seen, area, 0.005 * area) << tilt;
  }
}

// The limit is a quarter of the distance between positions, 1/64 px, along the slope of the surface that owns them.
TEST(ComposeWindow, ASpeckBelongsToASurfaceThatIsHardlyNearer) {
  constexpr float kSlope = 0.01f;  // per pixel
  for (const auto& [behind, shows] : {std::pair(kSlope / 128, true), {kSlope / 32, false}}) {
    SetupTriangles triangles;
    const auto at = [&](std::int32_t x, std::int32_t y, float z) {
      return ScreenPoint{x, y, -0.5f + kSlope * static_cast<float>(x) / 256 + z};
    };
    add_triangle(triangles, at(100, 100, behind), at(104, 100, behind), at(100, 104, behind));
    add_triangle(triangles, at(-1024, -1024, 0), at(3072, -1024, 0), at(-1024, 3072, 0));
    const float red = composed(triangles, {{1, 0, 0}, {0, 0, 1}}, kPixel, 256)[0].color.r;
    EXPECT_NEAR(red, shows ? 8.0 / 65536 : 0.0, 1e-7) << behind;
  }
}

TEST(ComposeWindow, WeightsOfAClosedSceneSumToOne) {
  // One big triangle closes every pixel. All colours are white, so the picture shows the weights.
  Random random(72);
  const Tile tile{0, 0, 16, 16};
  SetupTriangles triangles = random_triangles(random, 600);
  add_triangle(triangles, everywhere(-0.01f));
  const std::vector<glm::vec3> white(triangles.triangles.size(), glm::vec3(1));
  for (const PixelColor& pixel : composed(triangles, white, tile, 256)) {
    ASSERT_NEAR(pixel.alpha, 1.0, 1e-5);
    ASSERT_NEAR(pixel.color.g, 1.0, 1e-5);
  }
  for (const PixelColor& pixel : composed(triangles, white, tile, 32)) ASSERT_NEAR(pixel.alpha, 1.0, 1e-5);
}

TEST(ComposeWindow, EqualDepthKeepsTheEarlier) {
  SetupTriangles triangles;
  for (int i = 0; i < 3; ++i) add_triangle(triangles, everywhere(-0.5f));
  EXPECT_EQ(composed(triangles, {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, kPixel, 256).at(0).color, glm::vec3(1, 0, 0));
}

TEST(ComposeWindow, WindowsSeparateWhatDoesNotOverlapInDepth) {
  SetupTriangles triangles = triangles_of({left_of(100, -0.75f), left_of(150, -0.5f), everywhere(-0.25f)});
  std::vector<float> windows;
  composed(triangles, std::vector<glm::vec3>(3, glm::vec3(1)), kPixel, 256, &windows);
  EXPECT_EQ(windows, std::vector<float>{1});
}

// To leave out what is hidden behind full pixels changes nothing that is visible.
TEST(ComposeWindow, ClosedPixelsHideNothingThatIsSeen) {
  Random random(74);
  const Tile tile{0, 0, 16, 16};
  SetupTriangles front = random_triangles(random, 200);
  add_triangle(front, everywhere(-0.6f));
  SetupTriangles all = front;
  const SetupTriangles behind = random_triangles(random, 200);
  const auto first_behind = static_cast<std::uint32_t>(all.triangles.size());
  for (const SetupTriangle& triangle : behind.triangles) {
    SetupTriangle moved = triangle;  // moved behind the wall
    for (float& z : moved.vertex_z) z = -0.5f;
    moved.depth.z = -0.5, moved.depth.dzdx = moved.depth.dzdy = 0;
    all.triangles.push_back(moved);
  }
  std::vector<glm::vec3> colors(all.triangles.size(), glm::vec3(0, 0, 1));
  std::fill_n(colors.begin(), first_behind, glm::vec3(1, 0.5f, 0));
  const std::vector<PixelColor> found = composed(all, colors, tile, 256), expected = composed(front, colors, tile, 256);
  for (std::size_t i = 0; i < found.size(); ++i) ASSERT_EQ(found[i].color, expected[i].color);
}

TEST(ComposeWindow, NothingThereIsTransparent) {
  const PixelColor found = composed(SetupTriangles{}, {}, kPixel, 256).at(0);
  EXPECT_EQ(found.alpha, 0.0f);
  EXPECT_EQ(found.color, glm::vec3(0));
}

TEST(PositionSet, IsThereForFourNumbersOfPositions) {
  for (const int count : {32, 64, 128, 256}) EXPECT_EQ(cell_positions(count).count(), count);
  EXPECT_THROW(cell_positions(96), std::invalid_argument);
}

TEST(PositionSet, TheNearestPositionsAreTheNearest) {
  const PositionSet positions(cell_patterns(128));
  Random random(73);
  for (int i = 0; i < 2000; ++i) {
    // The centre of a place of the table, where the table is exact.
    const int x = random.int32(0, 63), y = random.int32(0, 63);
    const auto& found = positions.nearest_to((static_cast<float>(x) + 0.5f) / 64, (static_cast<float>(y) + 0.5f) / 64);
    std::vector<int> distances;
    for (const SamplePattern& pattern : positions.patterns)
      for (std::size_t s = 0; s < 32; ++s) {
        const int dx = pattern.x[s] - (4 * x + 2), dy = pattern.y[s] - (4 * y + 2);
        distances.push_back(dx * dx + dy * dy);
      }
    std::vector<int> sorted = distances;
    std::sort(sorted.begin(), sorted.end());
    for (std::size_t k = 0; k < 3; ++k) ASSERT_EQ(distances[found[k]], sorted[k]);
  }
}

}  // namespace beampipe::compose_beam_test
