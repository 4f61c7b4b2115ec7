// The part of texels that passes the alpha test.
#include "stages/surface/tested_alpha.h"

#include "stages/surface/texture_filter.h"
#include "stages/surface/texture_set.h"
#include "tests/message_of.h"
#include "tests/simd/random.h"
#include "tests/stages/surface/color_of_texel.h"
#include "tests/stages/surface_scene.h"

namespace beampipe::tested_alpha_test {

TextureImage noise(std::uint32_t width, std::uint32_t height) {
  Random random(7);
  return image_with_alphas(width, height, [&](std::size_t) { return random.word(); });
}

// Against tests at many points with the filter that pictures use. 64 places in a texel are within 0.05 here.
TEST(TestedAlpha, SharesAreThoseOfManyPoints) {
  const TextureImage image = noise(5, 3);
  const MipChain chain = make_mip_chain(image, ColorSpace::srgb);
  for (const Filter filter : {Filter::nearest, Filter::linear})
    for (const Wrap wrap : {Wrap::repeat, Wrap::clamp, Wrap::mirror}) {
      Material material = textured_material(0, AlphaMode::mask);
      Texture& texture = *material.base_texture;
      texture.magnify = filter, texture.wrap_u = texture.wrap_v = wrap;
      material.base_color.a = 0.8f, material.alpha_cutoff = 0.4f;
      const TestedAlpha tested = test_alpha(material, image);
      EXPECT_FLOAT_EQ(tested.first, 0.5f);
      constexpr int kPoints = 50;  // along each side of a texel
      for (std::uint32_t y = 0; y < image.height; ++y)
        for (std::uint32_t x = 0; x < image.width; ++x)
          for (const float needed : {0.5f, 2 / 3.0f, 5 / 6.0f}) {
            int passed = 0;
            for (int i = 0; i < kPoints * kPoints; ++i) {
              const glm::vec2 uv((static_cast<float>(x) + (i % kPoints + 0.5f) / kPoints) / 5,
                                 (static_cast<float>(y) + (i / kPoints + 0.5f) / kPoints) / 3);
              passed += filtered_level(chain, texture, 0, uv, filter, [](std::size_t, auto, auto) {}).a >= needed;
            }
            EXPECT_NEAR(tested.share(color_of_texel(tested.shares, 0, x, y), needed),
                        passed / static_cast<double>(kPoints * kPoints), filter == Filter::nearest ? 1e-4 : 0.06)
                << x << ", " << y << ": " << needed;
          }
    }
}

TEST(TestedAlpha, LevelsAreMeansOfShares) {
  const TextureImage image = noise(8, 8);
  Material material = textured_material(0, AlphaMode::mask);
  material.base_texture->magnify = Filter::nearest;
  const MipChain shares = test_alpha(material, image).shares;
  double passed = 0;
  for (const glm::u8vec4& texel : image.texels) passed += texel.a >= 128;
  ASSERT_EQ(shares.levels.size(), 4u);
  EXPECT_NEAR(color_of_texel(shares, 3, 0, 0)[0], passed / 64, 1 / 255.0);
}

// Between its values a share is interpolated; above all of them there is nothing.
TEST(TestedAlpha, SharesOfOtherAlphas) {
  const TestedAlpha tested{0.25f, 0.25f, {}};
  const glm::vec4 there(1.0f, 0.5f, 0.25f, 0.125f);
  EXPECT_EQ(tested.share(there, 0.125f), 1.0f);
  EXPECT_EQ(tested.share(there, 0.25f), 1.0f);
  EXPECT_EQ(tested.share(there, 0.375f), 0.75f);
  EXPECT_EQ(tested.share(there, 0.75f), 0.25f);
  EXPECT_EQ(tested.share(there, 1.0f), 0.125f);
  EXPECT_EQ(tested.share(there, 1.001f), 0.0f);
  EXPECT_EQ(tested.share(there, INFINITY), 0.0f);
}

TEST(TestedAlpha, MaterialsWithTheSameTestShareIt) {
  Trace trace;
  trace.images = {noise(4, 4)};
  trace.materials.assign(3, textured_material(0, AlphaMode::mask));
  trace.materials[1].roughness = 0.5f;
  trace.materials[2].alpha_cutoff = 0.75f;
  const TextureSet set(trace);
  set.test_alphas(trace, {true, true, true});
  EXPECT_EQ(&set.tested_alpha(0), &set.tested_alpha(1));
  EXPECT_NE(&set.tested_alpha(0), &set.tested_alpha(2));
  EXPECT_EQ(set.tested_alpha(2).first, 0.75f);
}

// 5.6 MB of results each, a thousand times: refused before memory is taken for them.
TEST(TestedAlpha, RefusesTooManyCutoffs) {
  Trace trace;
  trace.images = {filled_image(1024, 1024, {1, 2, 3, 4})};
  for (int i = 1; i <= 1000; ++i) {
    trace.materials.push_back(textured_material(0, AlphaMode::mask));
    trace.materials.back().alpha_cutoff = static_cast<float>(i) / 1000;
    trace.materials.back().name = std::to_string(i);
  }
  const TextureSet set(trace, "leaves.json");
  EXPECT_EQ(
      message_of<std::runtime_error>([&] { set.test_alphas(trace, std::vector<bool>(1000, true)); }),
      "leaves.json: material \"769\": cutouts test their textures at too many cutoffs: expected at most 4096 MiB of "
      "results");
}

TEST(TestedAlpha, OnlyMaterialsThatAreAskedForAreTested) {
  Trace trace;
  trace.images = {noise(4, 4)};
  trace.materials.assign(2, textured_material(0, AlphaMode::mask));
  trace.materials[1].alpha_cutoff = 0.75f;
  const TextureSet set(trace);
  set.test_alphas(trace, {false, true});
  EXPECT_TRUE(set.tested_alpha(0).shares.levels.empty());
  EXPECT_FALSE(set.tested_alpha(1).shares.levels.empty());
}

}  // namespace beampipe::tested_alpha_test
