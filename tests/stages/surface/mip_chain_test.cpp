// Compares mip chains with sums over the image in double precision.
#include "stages/surface/mip_chain.h"

#include "stages/surface/texture_set.h"
#include "tests/simd/random.h"
#include "tests/stages/surface/color_of_texel.h"
#include "tests/stages/surface_scene.h"

namespace beampipe::mip_chain_test {

double linear_of(int code) {  // IEC 61966-2-1
  const double encoded = code / 255.0;
  return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}

double encoded_of(double linear) {
  return linear <= 0.0031308 ? linear * 12.92 : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}

TEST(MipChain, SrgbCodesAreThoseOfTheStandardAndComeBack) {
  for (int code = 0; code < 256; ++code) {
    const float value = srgb_values()[static_cast<std::size_t>(code)];
    EXPECT_NEAR(value, linear_of(code), 1e-7);
    EXPECT_EQ(srgb_code(value), code);
  }
}

TEST(MipChain, AValueGetsTheNearestCode) {
  for (int i = -100; i <= 10'100; ++i) {
    const double linear = i / 10'000.0, exact = 255 * encoded_of(std::clamp(linear, 0.0, 1.0));
    EXPECT_LE(std::abs(srgb_code(static_cast<float>(linear)) - exact), 0.5 + 1e-4) << linear;
  }
}

TEST(MipChain, SizesAreHalvedAndRoundedDown) {
  Random random(1);
  const auto sizes_of = [&](std::uint32_t width, std::uint32_t height) {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> sizes;
    for (const MipLevel& level : make_mip_chain(random_image(random, width, height), ColorSpace::srgb).levels) {
      EXPECT_EQ(level.texels.size(), std::size_t{level.width} * level.height);
      sizes.emplace_back(level.width, level.height);
    }
    return sizes;
  };
  using Sizes = std::vector<std::pair<std::uint32_t, std::uint32_t>>;
  EXPECT_EQ(sizes_of(1, 1), (Sizes{{1, 1}}));
  EXPECT_EQ(sizes_of(8, 2), (Sizes{{8, 2}, {4, 1}, {2, 1}, {1, 1}}));
  EXPECT_EQ(sizes_of(1, 7), (Sizes{{1, 7}, {1, 3}, {1, 1}}));
  EXPECT_EQ(sizes_of(13, 6), (Sizes{{13, 6}, {6, 3}, {3, 1}, {1, 1}}));
}

// The part of the texel [i, i + 1) of a level with `size` texels that the image's texel k covers, where the image has
// `whole` texels on the same axis; times the number of the image's texels in a texel.
double overlap(double i, double size, double k, double whole) {
  const double scale = whole / size;
  return std::max(0.0, std::min((i + 1) * scale, k + 1) - std::max(i * scale, k));
}

// Every level is a box filter of the image: box filters of box filters are, where sizes divide, and elsewhere too,
// because each texel covers the same part of the image.
TEST(MipChain, ATexelIsTheMeanOfWhatItCoversInLinearLight) {
  Random random(2);
  const std::pair<std::uint32_t, std::uint32_t> kSizes[] = {{16, 8}, {1, 16}, {2, 2}, {32, 32}, {5, 3}, {7, 7}, {3, 1}};
  for (const auto& [width, height] : kSizes) {
    for (const ColorSpace space : {ColorSpace::linear, ColorSpace::srgb}) {
      const TextureImage image = random_image(random, width, height);
      const MipChain chain = make_mip_chain(image, space);
      for (std::size_t l = 0; l < std::min<std::size_t>(chain.levels.size(), 2); ++l) {  // of the image itself
        const MipLevel& level = chain.levels[l];
        for (std::uint32_t y = 0; y < level.height; ++y)
          for (std::uint32_t x = 0; x < level.width; ++x)
            for (int c = 0; c < 4; ++c) {
              const bool is_srgb = space == ColorSpace::srgb && c < 3;
              double sum = 0, area = 0;
              for (std::uint32_t j = 0; j < height; ++j)
                for (std::uint32_t i = 0; i < width; ++i) {
                  const double part = overlap(x, level.width, i, width) * overlap(y, level.height, j, height);
                  const int code = image.texels[j * width + i][c];
                  sum += part * (is_srgb ? linear_of(code) : code / 255.0);
                  area += part;
                }
              const double code = 255 * (is_srgb ? encoded_of(sum / area) : sum / area);
              ASSERT_LE(std::abs(level.texels[y * level.width + x][c] - code), 0.5 + 1e-3)
                  << width << " x " << height << ", level " << l << ": " << x << ", " << y << ", " << c;
            }
      }
    }
  }
}

TEST(MipChain, TheSmallestLevelIsTheMeanOfTheImage) {
  Random random(3);
  const std::pair<std::uint32_t, std::uint32_t> kSizes[] = {{16, 8}, {1, 16}, {64, 64}, {5, 3}, {21, 13}, {3, 127}};
  for (const auto& [width, height] : kSizes) {
    const TextureImage image = random_image(random, width, height);
    for (const ColorSpace space : {ColorSpace::linear, ColorSpace::srgb}) {
      const MipChain chain = make_mip_chain(image, space);
      for (int c = 0; c < 4; ++c) {
        const bool is_srgb = space == ColorSpace::srgb && c < 3;
        double sum = 0;
        for (const glm::u8vec4& texel : image.texels) sum += is_srgb ? linear_of(texel[c]) : texel[c] / 255.0;
        const double mean = sum / static_cast<double>(image.texels.size());
        EXPECT_LE(std::abs(chain.levels.back().texels[0][c] - 255 * (is_srgb ? encoded_of(mean) : mean)), 0.5 + 1e-3)
            << width << " x " << height;
        EXPECT_NEAR(color_of_texel(chain, chain.levels.size() - 1, 0, 0)[c], mean, 0.006);
      }
    }
  }
}

TEST(MipChain, ASetHasTheColorSpacesThatMaterialsRead) {
  Trace trace;
  trace.images = {{"a", 1, 1, {{188, 188, 188, 128}}}, {"b", 1, 1, {{188, 188, 188, 128}}}};
  trace.materials.resize(2);
  trace.materials[0].base_texture = Texture{.image = 0};
  trace.materials[0].normal_texture = Texture{.image = 1};
  trace.materials[1].metallic_roughness_texture = Texture{.image = 0};
  trace.materials[1].emissive_texture = Texture{.image = 1};
  const TextureSet set(trace);
  for (const std::uint32_t image : {0u, 1u}) {
    EXPECT_NEAR(color_of_texel(set.chain(image, ColorSpace::srgb), 0, 0, 0).r, 0.5, 0.003);
    EXPECT_NEAR(color_of_texel(set.chain(image, ColorSpace::linear), 0, 0, 0).r, 188 / 255.0, 1e-6);
    EXPECT_NEAR(color_of_texel(set.chain(image, ColorSpace::srgb), 0, 0, 0).a, 128 / 255.0, 1e-6);
  }
}

}  // namespace beampipe::mip_chain_test
