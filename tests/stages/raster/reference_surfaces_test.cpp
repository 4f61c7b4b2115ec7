// The reference with surfaces that vary, against closed forms.
#include <numbers>

#include "stages/raster/reference_raster.h"
#include "tests/simd/random.h"
#include "tests/stages/screen_triangles.h"
#include "tests/stages/surface_scene.h"

namespace beampipe::reference_surfaces_test {

std::vector<glm::vec4> picture(const Trace& trace) {
  const ShadedScene scene(trace);
  const Tile tile = scene.frame_tile();
  const TileShader shader(scene.shader, tile);
  ReferenceTile samples(tile);
  StageCounters counters;
  reference_raster({scene.triangles, all_of(scene.triangles), tile}, counters, samples, &shader);
  return resolve(samples, tile, shader, trace.frames[0].background, counters);
}

// Between the centres of two texels a linear filter is linear: red grows from 0 to 1 from the left side of the
// rectangle to its right side.
std::uint32_t add_ramp(SurfaceTrace& scene) {
  return scene.add_image({"ramp", 2, 1, {{0, 0, 0, 255}, {255, 0, 0, 255}}});
}
void show_ramp(SurfaceTrace& scene) { scene.mesh().uvs[0] = {{0.25f, 0}, {0.75f, 0}, {0.75f, 1}, {0.25f, 1}}; }

// The mean of a linear function over what is covered is its value at the middle of that.
TEST(ReferenceSurfaces, ALinearTextureIntegratesExactly) {
  SurfaceTrace scene(12, 4);
  const double left = 1.25, right = 10.75, top = 0.5, bottom = 3.125;
  scene.add_rectangle(left, top, right, bottom, 0.5, textured_material(add_ramp(scene)));
  show_ramp(scene);
  scene.frame().background = glm::vec3(0, 0, 1);
  const std::vector<glm::vec4> found = picture(scene.trace);
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 12; ++x) {
      const double from = std::clamp<double>(x, left, right), to = std::clamp<double>(x + 1, left, right);
      const double rows = std::clamp<double>(y + 1, top, bottom) - std::clamp<double>(y, top, bottom);
      const double area = (to - from) * rows, value = ((from + to) / 2 - left) / (right - left);
      const glm::vec4& pixel = found[static_cast<std::size_t>(12 * y + x)];
      // The shifts of the covered rows have a mean that is off by up to 3.5 / 4096 px in the highest and lowest pixels,
      // which changes red by 1.2e-5. In the columns of the left and right border, samples are off by up to 1/16 px.
      const double bound = to - from < 1 ? 1.0 / 16 / (right - left) / 16 : 1e-6;
      EXPECT_NEAR(pixel.r, area * value, bound + (rows < 1 ? 1.2e-5 : 0)) << x << ", " << y;
      EXPECT_NEAR(pixel.b, 1 - area, 1e-6);
      EXPECT_NEAR(pixel.a, area, 1e-6);
    }
}

TEST(ReferenceSurfaces, AConstantTextureIsTheFlatColor) {
  SurfaceTrace textured(16, 16), flat(16, 16);
  const std::uint32_t white = textured.add_image(filled_image(4, 4, {255, 255, 255, 255}));
  const double corners[][4] = {{1.2, 2.7, 9.3, 8.8}, {4.4, 1.3, 14.9, 12.2}, {0, 9.1, 16, 11.6}};
  for (std::size_t i = 0; i < 3; ++i) {
    const glm::vec4 color(0.1 * static_cast<double>(i + 1), 0.7, 1 / (2.0 + static_cast<double>(i)), 1);
    const auto& c = corners[i];
    Material material = textured_material(white);
    material.base_color = color;
    textured.add_rectangle(c[0], c[1], c[2], c[3], 0.9 - 0.2 * static_cast<double>(i), material);
    flat.add_rectangle(c[0], c[1], c[2], c[3], 0.9 - 0.2 * static_cast<double>(i), unlit_material(color));
  }
  const std::vector<glm::vec4> a = picture(textured.trace), b = picture(flat.trace);
  for (std::size_t i = 0; i < a.size(); ++i)
    for (int c = 0; c < 4; ++c) EXPECT_NEAR(a[i][c], b[i][c], 3e-7);  // filtering a constant rounds
}

// Texels far smaller than a pixel, black and white in turn: the mean is half the light, whatever the encoding.
TEST(ReferenceSurfaces, AFineCheckerIsTheMeanInLinearLight) {
  TextureImage image = filled_image(256, 256, {255, 255, 255, 255});
  for (std::size_t i = 0; i < image.texels.size(); ++i)
    if ((i + i / 256) % 2) image.texels[i] = {0, 0, 0, 255};
  for (const glm::vec4& pixel : picture(full_of(image, AlphaMode::opaque, 4).trace))
    EXPECT_NEAR(pixel.r, 0.5, 0.003);  // an 8-bit code
}

// Alpha falls linearly with the distance from the middle and is half a code above the cutoff on the circle.
TEST(ReferenceSurfaces, ACutoutCircleHasItsArea) {
  constexpr int kTexels = 256;
  constexpr double kRadius = 0.4 * kTexels, kCodesPerTexel = 16;
  TextureImage image = filled_image(kTexels, kTexels, {255, 255, 255, 255});
  for (int y = 0; y < kTexels; ++y)
    for (int x = 0; x < kTexels; ++x) {
      const double distance = std::hypot(x + 0.5 - kTexels / 2.0, y + 0.5 - kTexels / 2.0);
      image.texels[static_cast<std::size_t>(kTexels * y + x)].a =
          static_cast<std::uint8_t>(std::clamp(std::round(128 + kCodesPerTexel * (kRadius - distance)), 0.0, 255.0));
    }
  for (const double size : {64.0, 20.5}) {  // texels are larger than samples, as a cutout's reference needs them
    SurfaceTrace scene(65, 65);
    Material material = textured_material(scene.add_image(image), AlphaMode::mask);
    material.alpha_cutoff = 128 / 255.0f;
    scene.add_rectangle(0.25, 0.25, 0.25 + size, 0.25 + size, 0.5, material);
    double area = 0;
    for (const glm::vec4& pixel : picture(scene.trace)) area += pixel.a;
    const double radius = kRadius * size / kTexels, circle = std::numbers::pi * radius * radius;
    // Codes are off by up to 1/2: 1/32 texel on the border, if all are off in the same direction. The filter's chords
    // lie within 1 / (8 r) texels of the circle.
    const double texel = size / kTexels, border = 2 * std::numbers::pi * radius;
    EXPECT_NEAR(area, circle, border * texel * (1.0 / 32 + 1 / (8 * kRadius)) + 2 * border / 4096) << size;
    EXPECT_NEAR(area, circle, 0.002 * circle);
  }
}

TEST(ReferenceSurfaces, TranslucentLayersMultiplyInAnyOrder) {
  Random random(1);
  for (int round = 0; round < 12; ++round) {
    constexpr std::size_t kLayers = 6;
    std::vector<glm::dvec4> colors(kLayers);  // from near to far; one of them is opaque in half of the rounds
    for (glm::dvec4& c : colors) c = {random.real(0, 1), random.real(0, 1), random.real(0, 1), random.real(0.05, 0.9)};
    if (round % 2) colors[4].a = 1;
    std::vector<std::size_t> order(kLayers);
    std::iota(order.begin(), order.end(), std::size_t{0});
    random.shuffle(order);
    SurfaceTrace scene(3, 3);
    scene.frame().background = glm::vec3(0.25f, 0.5f, 0.75f);
    for (const std::size_t layer : order)
      scene.add_rectangle(-1, -1, 4, 4, 0.1 + 0.1 * static_cast<double>(layer),
                          unlit_material(colors[layer], colors[layer].a == 1 ? AlphaMode::opaque : AlphaMode::blend));
    glm::dvec3 expected(0);
    double light = 1;
    for (const glm::dvec4& c : colors) expected += light * c.a * glm::dvec3(c), light *= 1 - c.a;
    expected += light * glm::dvec3(scene.frame().background);
    for (const glm::vec4& pixel : picture(scene.trace)) {
      for (int c = 0; c < 3; ++c) ASSERT_NEAR(pixel[c], expected[c], 1e-6) << round;
      ASSERT_NEAR(pixel.a, 1 - light, 1e-6);
    }
  }
}

// Half of the pixel has the layer, and a flat surface lies in front of a part of that.
TEST(ReferenceSurfaces, LayersCoverWhatTheyCover) {
  SurfaceTrace scene(1, 1);
  scene.frame().background = glm::vec3(0, 0, 1);
  scene.add_rectangle(0, 0, 0.5, 1, 0.5, unlit_material({1, 0, 0, 0.5f}, AlphaMode::blend));
  scene.add_rectangle(0.25, 0, 1, 0.5, 0.25, unlit_material({0, 1, 0, 1}));
  const glm::vec4 pixel = picture(scene.trace)[0];
  const double green = 0.75 * 0.5, layer = 0.5 - 0.25 * 0.5;
  EXPECT_NEAR(pixel.r, layer / 2, 1e-6);
  EXPECT_NEAR(pixel.g, green, 1e-6);
  EXPECT_NEAR(pixel.b, 1 - green - layer / 2, 1e-6);
  EXPECT_NEAR(pixel.a, green + layer / 2, 1e-6);
}

}  // namespace beampipe::reference_surfaces_test
