// The reference takes a cutout's samples where alpha at each of them says so, though it does not ask at each of them.
#include "stages/raster/cutout_cells.h"

#include "stages/raster/reference_raster.h"
#include "tests/simd/random.h"
#include "tests/stages/screen_triangles.h"
#include "tests/stages/surface_scene.h"
#include "traces/scenes.h"

namespace beampipe::cutout_cells_test {

// Counts the samples that a triangle covers, by whether it is there. Every one must be as alpha there says.
std::array<std::size_t, 2> test_every_sample(const ShadedScene& scene, const Tile& tile, std::uint32_t triangle,
                                             const ReferencePattern& pattern) {
  const TileShader shader(scene.shader, tile);
  SetupTriangles opaque = scene.triangles;
  for (SetupSurface& surface : opaque.surfaces) surface.is_opaque = true;
  ReferenceTile covered(tile, pattern), taken(tile, pattern);
  StageCounters counters;
  reference_raster({opaque, {triangle}, tile}, counters, covered);
  reference_raster({scene.triangles, {triangle}, tile}, counters, taken, &shader);
  std::array<std::size_t, 2> found{};
  std::size_t wrong = 0;
  const auto columns = static_cast<std::size_t>(pattern.columns), rows = static_cast<std::size_t>(pattern.rows());
  for (std::size_t i = 0; i < covered.owner.size(); ++i) {
    const std::size_t row = i / covered.row_samples, column = i % covered.row_samples;
    const auto pixel =
        static_cast<std::uint32_t>(row / rows * static_cast<std::size_t>(tile.width()) + column / columns);
    const ReferencePattern::Place first = pattern.first_in_row(static_cast<std::int64_t>(row));
    const auto x = static_cast<std::int32_t>(first.x) +
                   pattern.units() / pattern.columns * static_cast<std::int32_t>(column % columns);
    const float unit = 1.0f / static_cast<float>(pattern.units());
    const bool is_there = covered.owner[i] != kNoOwner &&
                          shader.alpha(triangle, pixel, static_cast<float>(x) * unit,
                                       static_cast<float>(first.y) * unit, 0.0f) >= shader.alpha_cutoff(triangle);
    wrong += is_there != (taken.owner[i] != kNoOwner);
    if (covered.owner[i] != kNoOwner) ++found[is_there];
  }
  EXPECT_EQ(wrong, 0u) << "triangle " << triangle << ", tile at " << tile.x0 << ", " << tile.y0;
  return found;
}

TEST(CutoutCells, AgreeWithEverySampleInPerspective) {
  const ShadedScene scene(make_scene("leaves", {.triangles = 1000, .width = 320, .height = 180}));
  std::array<std::size_t, 2> found{};
  std::size_t tested = 0;
  for (const std::int32_t y : {60, 101})
    for (const std::int32_t x : {81, 160, 242})
      for (std::uint32_t i = 0; i < scene.triangles.triangles.size() && tested < 30; ++i) {
        const Tile tile{x, y, x + 2, y + 2};
        const SetupTriangle& t = scene.triangles.triangles[i];
        const auto [left, right] = std::minmax({t.x[0], t.x[1], t.x[2]});
        const auto [top, bottom] = std::minmax({t.y[0], t.y[1], t.y[2]});
        if (!scene.shader.is_cutout(i) || right < 256 * x || left > 256 * (x + 2) || bottom < 256 * y ||
            top > 256 * (y + 2))
          continue;
        ++tested;
        const std::array<std::size_t, 2> of_triangle = test_every_sample(scene, tile, i, {});
        found[0] += of_triangle[0], found[1] += of_triangle[1];
      }
  EXPECT_GT(found[0], 10000u);
  EXPECT_GT(found[1], 10000u);
}

TEST(CutoutCells, AgreeWithEverySampleForAnySampler) {
  Random random(7);
  for (int round = 0; round < 24; ++round) {
    SurfaceTrace scene(3, 3);
    TextureImage image = random_image(random, 7, 5);
    for (std::size_t i = 0; i < image.texels.size(); ++i)  // areas without and with edges
      image.texels[i].a = i % 7 < 3 ? 255 : i % 7 < 5 ? 0 : image.texels[i].a;
    Material material = textured_material(scene.add_image(image), AlphaMode::mask);
    material.base_color.a = random.real32(0.5f, 1.0f);
    material.alpha_cutoff = random.real32(0.1f, 0.9f);
    material.base_texture->wrap_u = static_cast<Wrap>(round % 3);
    material.base_texture->wrap_v = static_cast<Wrap>(round / 3 % 3);
    if (round % 2) material.base_texture->magnify = Filter::nearest;
    scene.add_rectangle(-0.5, 0.25, 3.75, 2.75, 0.5, material);
    for (glm::vec2& uv : scene.mesh().uvs[0])
      uv = 0.6f * uv + glm::vec2(random.real32(-1.2f, 1.2f), random.real32(-1.2f, 1.2f));
    const ShadedScene shaded(scene.trace);
    for (std::uint32_t i = 0; i < shaded.triangles.triangles.size(); ++i)
      test_every_sample(shaded, shaded.frame_tile(), i, {round % 4 == 0 ? 32 : 16, 1 + round % 4});
  }
}

TEST(CutoutCells, KnowAreasOfOneKind) {
  SurfaceTrace scene(4, 1);
  TextureImage image = filled_image(64, 16, {255, 255, 255, 255});
  for (std::size_t i = 0; i < image.texels.size(); ++i)
    if (i % 64 < 24) image.texels[i].a = 0;
  Material material = textured_material(scene.add_image(image), AlphaMode::mask);
  material.base_texture->wrap_u = Wrap::clamp;
  scene.add_rectangle(0, 0, 4, 1, 0.5, material);
  const ShadedScene shaded(scene.trace);
  const TileShader shader(shaded.shader, shaded.frame_tile());
  CutoutCells cells(shader, shaded.frame_tile(), 16);
  cells.start(0);
  EXPECT_EQ(cells.of_pixel(0), CutoutCover::none);
  EXPECT_EQ(cells.of_pixel(1), CutoutCover::mixed) << "the edge is in its middle";
  EXPECT_EQ(cells.of_cell(1, 2, 3), CutoutCover::none);
  EXPECT_EQ(cells.of_cell(1, 13, 3), CutoutCover::all);
  EXPECT_EQ(cells.of_pixel(3), CutoutCover::all);
}

}  // namespace beampipe::cutout_cells_test
