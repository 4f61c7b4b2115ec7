// Compares texture filtering with its definition in double precision.
#include "stages/surface/texture_filter.h"

#include "stages/surface/footprint_filter.h"
#include "stages/surface/texture_taps.h"
#include "tests/simd/every_target.h"
#include "tests/simd/random.h"
#include "tests/stages/surface/color_of_texel.h"
#include "tests/stages/surface_scene.h"

namespace beampipe::texture_filter_test {

constexpr float kInfinity = std::numeric_limits<float>::infinity(), kNan = std::numeric_limits<float>::quiet_NaN();

const auto kIgnored = [](std::size_t, std::uint32_t, std::uint32_t) {};

TEST(TextureFilter, TheLogarithmIsWithinItsBound) {
  Random random(1);
  const auto check = [&](float x) {
    ASSERT_NEAR(logarithm_2(x), std::log2(double{x}), 2e-6 + 0x1p-23 * std::abs(std::log2(x))) << x;
  };
  for (int i = 0; i < 200'000; ++i) {
    check(std::bit_cast<float>(static_cast<std::uint32_t>(random.integer(0x00800000, 0x7f7fffff))));
    check(random.real32(0.5, 2));
  }
  for (int exponent = -126; exponent <= 127; ++exponent) {
    EXPECT_EQ(logarithm_2(std::ldexp(1.0f, exponent)), static_cast<float>(exponent));
    check(std::nextafter(std::ldexp(1.0f, exponent), kInfinity));
    if (exponent > -126) check(std::nextafter(std::ldexp(1.0f, exponent), 0.0f));
  }
}

TEST(TextureFilter, TheLevelOfDetailIsTheLogarithmOfTheLongerSide) {
  Random random(2);
  for (int i = 0; i < 100'000; ++i) {
    const MipLevel image{
        static_cast<std::uint32_t>(random.integer(1, 16384)), static_cast<std::uint32_t>(random.integer(1, 16384)), {}};
    const double scale = std::exp2(random.real(-20, 10));
    const auto slope = [&] { return random.one_in(8) ? 0.0f : static_cast<float>(scale * random.real(-1, 1)); };
    const TextureSlopes slopes{{slope(), slope()}, {slope(), slope()}};
    const double along_x = std::hypot(double{slopes.dx.x} * image.width, double{slopes.dx.y} * image.height);
    const double along_y = std::hypot(double{slopes.dy.x} * image.width, double{slopes.dy.y} * image.height);
    const double longer = std::max(along_x, along_y);
    if (longer < 1e-12) continue;
    ASSERT_NEAR(level_of_detail(slopes, image), std::log2(longer), 1e-5) << longer;
  }
  const MipLevel image{256, 256, {}};
  EXPECT_LT(level_of_detail({}, image), -40);
  for (const float broken : {kNan, kInfinity, -kInfinity, 3e38f})
    for (int component = 0; component < 4; ++component) {
      TextureSlopes slopes{{1.0f, 1.0f}, {1.0f, 1.0f}};
      (component < 2 ? slopes.dx : slopes.dy)[component % 2] = broken;
      EXPECT_TRUE(std::isfinite(level_of_detail(slopes, image)));
    }
}

TEST(TextureFilter, WrapModesAreEnumerated) {
  const auto line = [](std::int32_t size, Wrap wrap) {
    std::vector<std::uint32_t> texels;
    for (std::int32_t i = -1; i <= 2 * size; ++i) texels.push_back(wrapped(i, static_cast<std::uint32_t>(size), wrap));
    return texels;
  };
  using Texels = std::vector<std::uint32_t>;
  EXPECT_EQ(line(3, Wrap::repeat), (Texels{2, 0, 1, 2, 0, 1, 2, 0}));
  EXPECT_EQ(line(3, Wrap::clamp), (Texels{0, 0, 1, 2, 2, 2, 2, 2}));
  EXPECT_EQ(line(3, Wrap::mirror), (Texels{0, 0, 1, 2, 2, 1, 0, 0}));
  for (const Wrap wrap : {Wrap::repeat, Wrap::clamp, Wrap::mirror}) EXPECT_EQ(line(1, wrap), Texels(4, 0));
  EXPECT_EQ(wrapped(-7, 3u, Wrap::clamp), 0u);
  EXPECT_EQ(wrapped(9, 3u, Wrap::clamp), 2u);
}

// The texel that a coordinate in texels falls on, in double precision.
std::uint32_t texel_at(double coordinate, std::uint32_t size, Wrap wrap) {
  const double n = size;
  double i = std::floor(coordinate);
  if (wrap == Wrap::clamp) i = std::clamp(i, 0.0, n - 1);
  if (wrap == Wrap::repeat) i -= n * std::floor(i / n);
  if (wrap == Wrap::mirror) {
    i -= 2 * n * std::floor(i / (2 * n));
    if (i >= n) i = 2 * n - 1 - i;
  }
  return static_cast<std::uint32_t>(i);
}

glm::dvec4 level_in_double(const MipChain& chain, const Texture& texture, std::size_t level, const glm::dvec2& uv,
                           Filter filter) {
  const MipLevel& image = chain.levels[level];
  const glm::dvec2 at(uv.x * image.width, uv.y * image.height);
  const auto texel = [&](double x, double y) {
    return glm::dvec4(color_of_texel(chain, level, texel_at(x, image.width, texture.wrap_u),
                                     texel_at(y, image.height, texture.wrap_v)));
  };
  if (filter == Filter::nearest) return texel(at.x, at.y);
  const double left = std::floor(at.x - 0.5), top = std::floor(at.y - 0.5);
  const double a = at.x - 0.5 - left, b = at.y - 0.5 - top;
  return (1 - b) * ((1 - a) * texel(left, top) + a * texel(left + 1, top)) +
         b * ((1 - a) * texel(left, top + 1) + a * texel(left + 1, top + 1));
}

glm::dvec4 filtered_in_double(const MipChain& chain, const Texture& texture, const glm::dvec2& uv, double lod) {
  const auto level = [&](double l, Filter filter) {
    return level_in_double(chain, texture, static_cast<std::size_t>(l), uv, filter);
  };
  if (lod <= 0) return level(0, texture.magnify);
  const auto last = static_cast<double>(chain.levels.size() - 1);
  if (texture.mip == MipFilter::none) return level(0, texture.minify);
  lod = std::min(lod, last);
  if (texture.mip == MipFilter::nearest) return level(std::ceil(lod + 0.5) - 1, texture.minify);  // OpenGL, 8.14.3
  const double finer = std::min(std::floor(lod), last), share = lod - finer;
  return (1 - share) * level(finer, texture.minify) + share * level(std::min(finer + 1, last), texture.minify);
}

// Without anisotropy.
Texture random_sampler(Random& random) {
  Texture texture;
  texture.wrap_u = random.pick(std::array{Wrap::repeat, Wrap::clamp, Wrap::mirror});
  texture.wrap_v = random.pick(std::array{Wrap::repeat, Wrap::clamp, Wrap::mirror});
  texture.magnify = random.pick(std::array{Filter::nearest, Filter::linear});
  texture.minify = random.pick(std::array{Filter::nearest, Filter::linear});
  texture.mip = random.pick(std::array{MipFilter::none, MipFilter::nearest, MipFilter::linear});
  return texture;
}

TEST(TextureFilter, AgreesWithADoubleTwin) {
  Random random(3);
  for (const auto& [width, height] : {std::pair{8u, 8u}, {5u, 3u}, {1u, 16u}, {64u, 2u}, {1u, 1u}}) {
    const TextureImage image = random_image(random, width, height);
    const MipChain linear = make_mip_chain(image, ColorSpace::linear), srgb = make_mip_chain(image, ColorSpace::srgb);
    for (int i = 0; i < 20'000; ++i) {
      const MipChain& chain = i % 2 ? srgb : linear;
      const Texture texture = random_sampler(random);
      const glm::vec2 uv(random.real32(-3, 4), random.real32(-3, 4));
      const double footprint = std::exp2(random.real(-3, 8));  // texels of level 0
      const TextureSlopes slopes{{static_cast<float>(footprint / width), 0}, {0, 0}};
      const double lod = std::log2(double{slopes.dx.x} * width);
      // Where nearest texels or levels meet, a rounding error decides.
      const auto is_near = [](double x, double margin) { return std::abs(x - std::round(x)) < margin; };
      bool decided = !is_near(lod - 0.5, 1e-4) && std::abs(lod) > 1e-4;
      for (const MipLevel& level : chain.levels)
        decided &= !is_near(double{uv.x} * level.width, 1e-4) && !is_near(double{uv.y} * level.height, 1e-4);
      if (!decided) continue;
      const glm::vec4 found = filtered(chain, texture, uv, slopes, kIgnored);
      const glm::dvec4 expected = filtered_in_double(chain, texture, uv, lod);
      // uv has 22 bits after the point here: 2^-22 of up to 64 texels, and the level is known within 1e-5.
      for (int c = 0; c < 4; ++c) ASSERT_NEAR(found[c], expected[c], 2e-4) << width << " x " << height << ", " << lod;
    }
  }
}

// The footprint is 8 texels long, along u, and `shorter` texels wide.
TEST(TextureFilter, ProbesLieEvenlyAlongTheLongerSide) {
  Random random(4);
  const MipChain chain = make_mip_chain(random_image(random, 256, 256), ColorSpace::linear);
  Texture texture;
  texture.minify = Filter::nearest, texture.mip = MipFilter::linear;
  const auto columns_read = [&](float shorter, std::uint32_t anisotropy, std::size_t of_level, float column) {
    texture.anisotropy = anisotropy;
    const glm::vec2 uv(column / static_cast<float>(chain.levels[of_level].width), 0.3f);
    std::vector<std::uint32_t> columns;
    for (const bool along_x : {true, false}) {
      const glm::vec2 along(8.0f / 256, 0), across(0, shorter / 256);
      const TextureSlopes slopes = along_x ? TextureSlopes{along, across} : TextureSlopes{across, along};
      std::vector<std::uint32_t> found;
      std::size_t reads = 0;
      filtered(chain, texture, uv, slopes, [&](std::size_t level, std::uint32_t x, std::uint32_t) {
        if (level == of_level) found.push_back(x);
        ++reads;
      });
      EXPECT_EQ(reads, filter_plan(chain, texture, slopes).texels());
      if (!along_x) {
        EXPECT_EQ(found, columns);
      }
      columns = found;
    }
    return columns;
  };
  using Columns = std::vector<std::uint32_t>;
  // 8 / 2 probes, in the level where 2 texels are one. They are one texel of that level apart.
  EXPECT_EQ(columns_read(2, 16, 1, 64.25f), (Columns{62, 63, 64, 65}));
  // 8 / 3 is rounded up to 3. The level is that of 8 / 3 texels, between 1 and 2.
  EXPECT_EQ(columns_read(3, 16, 1, 64.5f), (Columns{63, 64, 65}));
  // No more than the texture allows: two, in the level where 4 texels are one.
  EXPECT_EQ(columns_read(2, 2, 2, 32.125f), (Columns{31, 32}));
  // A footprint as wide as it is long.
  EXPECT_EQ(columns_read(8, 16, 3, 16.5f), (Columns{16}));
}

// More look-ups than are made at once, of all filters, also where coordinates are no numbers.
TEST(TextureFilter, SideBySideValuesAreTheSame) {
  Random random(7);
  for (const auto& [width, height] : {std::pair{8u, 8u}, {5u, 3u}, {1u, 16u}, {64u, 2u}, {1u, 1u}}) {
    const MipChain chain = make_mip_chain(random_image(random, width, height), ColorSpace::srgb);
    for (int round = 0; round < 100; ++round) {
      Texture texture = random_sampler(random);
      texture.anisotropy = static_cast<std::uint32_t>(random.pick(std::array{1, 16}));
      std::vector<glm::vec2> uvs(static_cast<std::size_t>(random.integer(0, 64)));
      std::vector<FilterPlan> plans;
      for (glm::vec2& uv : uvs) {
        const auto coordinate = [&] {
          return random.one_in(16) ? random.pick(std::array{kNan, kInfinity, -kInfinity, 1e30f, 16777215.5f})
                                   : random.real32(-3, 4);
        };
        const auto slope = [&] { return static_cast<float>(std::exp2(random.real(-8, 2)) * random.real(-1, 1)); };
        uv = {coordinate(), coordinate()};
        const TextureSlopes slopes{{slope(), slope()}, {slope(), slope()}};
        plans.push_back(random.one_in(2) ? filter_plan(chain, texture, slopes)
                                         : footprint_plan(chain, texture, slopes, random.pick(std::array{1, 4, 16})));
      }
      on_every_target([&] {
        std::vector<glm::vec4> values(uvs.size());
        filter_side_by_side(chain, texture, uvs, plans, values.data());
        for (std::size_t i = 0; i < uvs.size(); ++i)
          ASSERT_EQ(values[i], filtered(chain, texture, uvs[i], plans[i], kIgnored)) << i << ", " << uvs[i].x;
      });
    }
  }
}

TEST(TextureFilter, WhateverTheCoordinatesTheColorIsFiniteAndWithinTheImages) {
  Random random(6);
  const MipChain chain = make_mip_chain(random_image(random, 6, 9), ColorSpace::srgb);
  const float kHard[] = {kNan,    kInfinity, -kInfinity, 3e38f, -3e38f, 16777216.0f, -16777216.0f, 1e9f, -1e9f, 1e-40f,
                         -1e-40f, -1e-9f,    0.0f,       -0.0f, 1.0f,   0.99999994f, -0.99999994f, 2.0f, -2.0f};
  for (const Wrap wrap : {Wrap::repeat, Wrap::clamp, Wrap::mirror})
    for (const MipFilter mip : {MipFilter::none, MipFilter::nearest, MipFilter::linear})
      for (const Filter filter : {Filter::nearest, Filter::linear})
        for (const float u : kHard)
          for (const float v : kHard)
            for (const float slope : kHard) {
              Texture texture{.wrap_u = wrap, .wrap_v = wrap, .magnify = filter, .minify = filter, .mip = mip};
              std::size_t reads = 0;
              const glm::vec4 found = filtered(chain, texture, {u, v}, {{slope, v}, {u, slope}},
                                               [&](std::size_t level, std::uint32_t x, std::uint32_t y) {
                                                 ++reads;
                                                 ASSERT_LT(level, chain.levels.size());
                                                 ASSERT_LT(x, chain.levels[level].width);
                                                 ASSERT_LT(y, chain.levels[level].height);
                                               });
              ASSERT_TRUE(reads > 0 && reads <= 8);
              ASSERT_EQ(reads, filter_plan(chain, texture, {{slope, v}, {u, slope}}).texels());
              for (int c = 0; c < 4; ++c) ASSERT_TRUE(found[c] >= 0 && found[c] <= 1.000001f) << u << ", " << v;
            }
}

// Just left of 0 lies the last texel, and just left of 1 too.
TEST(TextureFilter, ThePeriodHasNoSeam) {
  const TextureImage image{"two", 2, 1, {{0, 0, 0, 255}, {255, 255, 255, 255}}};
  const MipChain chain = make_mip_chain(image, ColorSpace::linear);
  Texture texture;
  texture.magnify = Filter::nearest;
  for (const float u : {-1e-4f, -1e-6f, 1 - 1e-4f, -3 - 1e-4f})
    EXPECT_EQ(filtered(chain, texture, {u, 0.5f}, TextureSlopes{}, kIgnored).r, 1) << u;
  for (const float u : {1e-6f, 0.0f, 1.0f, -1.0f, 7.0f})
    EXPECT_EQ(filtered(chain, texture, {u, 0.5f}, TextureSlopes{}, kIgnored).r, 0);
}

}  // namespace beampipe::texture_filter_test
