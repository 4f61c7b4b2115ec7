#include "stages/picture/resolve.h"

#include "tests/stages/surface_scene.h"
#include "tests/test.h"

namespace beampipe::resolve_test {

TEST(Resolve, AggregateOverTheBackground) {
  Aggregate quarter = kEmptyAggregate;
  quarter.alpha = 0.25f;
  quarter.color[0] = 0.25f;  // red times alpha
  StageCounters counters;
  const auto image = resolve(pixel_colors({quarter, kEmptyAggregate}), {0, 1, 0.5f}, 42, counters);
  ASSERT_EQ(image.size(), 2u);
  EXPECT_EQ(image[0], glm::vec4(0.25f, 0.75f, 0.375f, 0.25f));
  EXPECT_EQ(image[1], glm::vec4(0, 1, 0.5f, 0));
  EXPECT_EQ(counters.items_in, 2u);
  EXPECT_EQ(counters.bytes_read, 2u * 42);
  EXPECT_EQ(counters.bytes_written, 2u * 6);
}

TEST(Resolve, MeanOfTheSamples) {
  const Tile tile{0, 0, 2, 1};
  const Sampling sampling{CellGrid{}, standard_pattern(4)};
  SampleTile surface(tile, sampling);
  // Left: triangle 0 twice, 1 once, background once. Right: background.
  surface.triangle[0] = surface.triangle[2] = 0;
  surface.triangle[1] = 1;
  StageCounters counters;
  const auto image =
      resolve(surface, tile.pixels(), std::vector<glm::vec3>{{1, 0, 0}, {0, 4, 0}}, {0, 0, 0.5f}, counters);
  ASSERT_EQ(image.size(), 2u);
  EXPECT_EQ(image[0], glm::vec4(0.5f, 1.0f, 0.125f, 0.75f));
  EXPECT_EQ(image[1], glm::vec4(0, 0, 0.5f, 0));
  EXPECT_EQ(counters.items_in, 8u);
  EXPECT_EQ(counters.items_out, 2u);
}

// Runs that begin and end anywhere.
TEST(Resolve, MeanOfManySamples) {
  const Tile tile{0, 0, 1, 1};
  SampleTile surface(tile, {CellGrid{8, 4}, standard_pattern(8)});
  for (std::size_t s = 0; s < 256; ++s) surface.triangle[s] = s < 11 ? 0 : s < 71 ? 1 : 2;
  StageCounters counters;
  const auto image =
      resolve(surface, 1, std::vector<glm::vec3>{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, glm::vec3(0), counters);
  EXPECT_EQ(image[0], glm::vec4(11.0f / 256, 60.0f / 256, 185.0f / 256, 1));
}

// A triangle that varies is shaded once in each cell where it has samples, and takes part with that many of them.
TEST(Resolve, VaryingTrianglesAreShadedInEachCell) {
  SurfaceTrace trace(2, 1);
  TextureImage image = filled_image(2, 1, {0, 0, 0, 255});
  image.texels[1] = {255, 255, 255, 255};
  Material material = textured_material(trace.add_image(image));
  material.base_texture->magnify = Filter::nearest;
  trace.add_rectangle(0, 0, 2, 1, 0.5, material);
  const ShadedScene scene(trace.trace);
  const TileShader shader(scene.shader, scene.frame_tile());
  SampleTile surface(scene.frame_tile(), {CellGrid{}, standard_pattern(8)});
  surface.triangle.assign(16, 0);
  surface.triangle[5] = kNoTriangle;
  std::vector<std::pair<std::uint32_t, std::size_t>> asked;
  StageCounters counters;
  const auto pixels =
      resolve(surface, 2, shader, glm::vec3(0), counters,
              {2, [&](std::uint32_t triangle, std::size_t cell) -> CellPlace {
                 asked.emplace_back(triangle, cell);
                 return {cell < 3 ? 0.5f : -0.5f, 0.5f, 0.25f};  // the left pixel is black and the right one is white
               }});
  // Of the left pixel's second cell, one run ends where the background is.
  EXPECT_EQ(asked, (std::vector<std::pair<std::uint32_t, std::size_t>>{{0, 0}, {0, 1}, {0, 1}, {0, 2}, {0, 3}}));
  EXPECT_EQ(pixels[0], glm::vec4(0, 0, 0, 7.0f / 8));
  EXPECT_EQ(pixels[1], glm::vec4(0.5f, 0.5f, 0.5f, 1));
}

// White, of luminance 1, becomes 1/2, and white of luminance 9 becomes 9/10. Their mean of 0.7 stands for 7/3. The
// linear mean is 5. A mean of equal samples is each of them.
TEST(Resolve, MeanInReinhardsSpace) {
  const Tile tile{0, 0, 2, 1};
  const Sampling sampling{CellGrid{}, standard_pattern(2)};
  SampleTile surface(tile, sampling);
  surface.triangle = {0, 1, 2, 2};
  const std::vector<glm::vec3> colors = {glm::vec3(1), glm::vec3(9), {4, 0.5f, 0.25f}};
  StageCounters counters, linear;
  const auto image = resolve(surface, tile.pixels(), colors, glm::vec3(0), counters, {.space = ResolveSpace::reinhard});
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(image[0][c], 7.0f / 3.0f, 1e-5f);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(image[1][c], colors[2][c], 1e-5f);
  EXPECT_EQ(image[0].a, 1.0f);
  EXPECT_EQ(resolve(surface, tile.pixels(), colors, glm::vec3(0), linear)[0], glm::vec4(5, 5, 5, 1));
  // To compress one of a pixel's two samples, or to expand their mean: three products and two sums make a luminance,
  // 1 is added or subtracted, and the inverse scales three channels.
  const OperationCounts once{.mul_add = 3 + 3, .add = 2 + 1, .special = 1};
  OperationCounts expected = linear.ops;
  EXPECT_EQ(counters.ops, expected += once * (2 * (2 + 1)));
  EXPECT_EQ(counters.bytes_read, linear.bytes_read);
}

}  // namespace beampipe::resolve_test
