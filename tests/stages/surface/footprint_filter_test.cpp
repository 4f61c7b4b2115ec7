// Compares means over footprints with integrals: of linear, checker and step textures, facing the viewer and grazing.
#include "stages/surface/footprint_filter.h"

#include "tests/simd/random.h"
#include "tests/stages/surface_scene.h"

namespace beampipe::footprint_filter_test {

const auto kIgnored = [](std::size_t, std::uint32_t, std::uint32_t) {};
constexpr std::uint32_t kSize = 256;  // of images, in texels

// `code(x, y)`: of the texel, 0..255.
template <class Code>
MipChain chain_of(Code&& code) {
  TextureImage image{"image", kSize, kSize, {}};
  for (std::uint32_t y = 0; y < kSize; ++y)
    for (std::uint32_t x = 0; x < kSize; ++x)
      image.texels.emplace_back(static_cast<std::uint8_t>(code(x, y)), 0, 0, 255);
  return make_mip_chain(image, ColorSpace::linear);
}

// `right`, `down`: the footprint's sides, and `at` its centre, all in texels.
double mean_of(const MipChain& chain, const Texture& texture, const glm::vec2& at, const glm::vec2& right,
               const glm::vec2& down, int taps) {
  const float texel = 1.0f / kSize;
  const FilterPlan plan = taps > 0 ? footprint_plan(chain, texture, {right * texel, down * texel}, taps)
                                   : filter_plan(chain, texture, {right * texel, down * texel});
  std::size_t reads = 0;
  const double mean = filtered(chain, texture, at * texel, plan, [&](auto...) { ++reads; }).r;
  EXPECT_EQ(reads, plan.texels());
  EXPECT_LE(reads, 4u * static_cast<unsigned>(std::max(taps, 2)));  // trilinear: two levels
  return mean;
}

// The root of the mean square of mean_of - truth(at, right, down) over random places.
template <class Truth>
double error_of(const MipChain& chain, const Texture& texture, const glm::vec2& right, const glm::vec2& down, int taps,
                Truth&& truth) {
  Random random(1);
  double sum = 0;
  constexpr int kPlaces = 2000;
  for (int i = 0; i < kPlaces; ++i) {
    const glm::vec2 at(random.real32(64, 192), random.real32(64, 192));
    const double error = mean_of(chain, texture, at, right, down, taps) - truth(at);
    sum += error * error;
  }
  return std::sqrt(sum / kPlaces);
}

TEST(FootprintFilter, TheMeanOfALinearTextureIsItsValueInTheMiddle) {
  const MipChain ramp = chain_of([](std::uint32_t x, std::uint32_t) { return x; });
  for (const auto& [right, down] : {std::pair{glm::vec2(12, 0), glm::vec2(0, 12)},  // facing
                                    {glm::vec2(3, 0), glm::vec2(0, 40)},            // grazing
                                    {glm::vec2(20, 18), glm::vec2(11, 12)}})        // grazing, at an angle
    for (const int taps : {1, 4, 16})
      EXPECT_LT(error_of(ramp, {}, right, down, taps, [](const glm::vec2& at) { return (at.x - 0.5) / 255; }),
                0.51 / 255)  // levels are rounded
          << right.x << ", " << taps;
}

// The mean over an interval of a wave that is 1 and -1 in turn, `half` long each.
double mean_of_wave(double middle, double length, double half) {
  const auto integral = [&](double x) {
    const double phase = x - 2 * half * std::floor(x / (2 * half));
    return phase < half ? phase : 2 * half - phase;
  };
  return (integral(middle + length / 2) - integral(middle - length / 2)) / length;
}

TEST(FootprintFilter, TheMeanOfACheckerIsItsIntegral) {
  constexpr std::uint32_t kCell = 10;  // texels
  const MipChain checker =
      chain_of([](std::uint32_t x, std::uint32_t y) { return (x / kCell + y / kCell) % 2 == 0 ? 255 : 0; });
  const auto errors = [&](float width, float height) {
    std::array<double, 4> found;
    for (std::size_t i = 0; i < 4; ++i)
      found[i] = error_of(checker, {}, {width, 0}, {0, height}, std::array{0, 1, 4, 16}[i], [&](const glm::vec2& at) {
        return 0.5 + 0.5 * mean_of_wave(at.x, width, kCell) * mean_of_wave(at.y, height, kCell);
      });
    return found;
  };
  // Facing: trilinear filtering takes a square, but blurs it.
  const auto [facing, facing_1, facing_4, facing_16] = errors(7, 7);
  EXPECT_LT(facing_16, 0.2 * facing);
  EXPECT_LT(facing_4, 0.6 * facing);
  EXPECT_LT(facing_1, facing);
  // Grazing: the square is as long as the footprint.
  const auto [grazing, grazing_1, grazing_4, grazing_16] = errors(2, 14);
  EXPECT_LT(grazing_16, 0.2 * grazing);
  EXPECT_LT(grazing_4, 0.7 * grazing);
}

// Cells of 1, 2, 4 and 8 texels are the finest detail of some level. Taps that lay two of its texels apart would see
// light cells alone, or dark ones.
TEST(FootprintFilter, CheckersOfTexelsOfALevelLeaveNoMoire) {
  for (const std::uint32_t cell : {1u, 2u, 4u, 8u}) {
    const MipChain checker =
        chain_of([&](std::uint32_t x, std::uint32_t y) { return (x / cell + y / cell) % 2 == 0 ? 255 : 0; });
    double worst = 0;
    for (const float side : {6.1f, 7.75f, 11.0f, 15.5f}) {
      const double found = error_of(checker, {}, {side, 0}, {0, side}, 16, [&](const glm::vec2& at) {
        return 0.5 + 0.5 * mean_of_wave(at.x, side, cell) * mean_of_wave(at.y, side, cell);
      });
      worst = std::max(worst, found);
    }
    EXPECT_LT(worst, 0.05) << cell;
  }
}

constexpr std::uint32_t kStep = 101;  // texels of black, and then white: no texel of a smaller level begins there

// The truth is a sum over many places in the parallelogram.
TEST(FootprintFilter, TheMeanOfAStepIsThePartOfTheParallelogramBeyondIt) {
  const MipChain step = chain_of([](std::uint32_t x, std::uint32_t) { return x < kStep ? 0 : 255; });
  const auto beyond = [](const glm::vec2& at, const glm::vec2& right, const glm::vec2& down) {
    constexpr int kPlaces = 1000;
    int sum = 0;  // along `right`, the part is known
    double part = 0;
    for (int i = 0; i < kPlaces; ++i, ++sum) {
      const double middle = at.x + down.x * ((i + 0.5) / kPlaces - 0.5);
      part += std::clamp((middle - kStep) / std::abs(double{right.x}) + 0.5, 0.0, 1.0);
    }
    return part / sum;
  };
  const auto errors = [&](const glm::vec2& right, const glm::vec2& down) {
    std::array<double, 2> sums{};
    Random random(2);
    for (int i = 0; i < 2000; ++i) {
      const glm::vec2 at(kStep + random.real32(-8, 8), random.real32(64, 192));
      for (const bool is_mean : {false, true}) {
        const double error = mean_of(step, {}, at, right, down, is_mean ? 16 : 0) - beyond(at, right, down);
        sums[is_mean] += error * error / 2000;
      }
    }
    return std::array{std::sqrt(sums[0]), std::sqrt(sums[1])};
  };
  struct Area {
    glm::vec2 right, down;
    double most;
  };
  // Sixteen taps reach over an area of 2 x 14 texels in the next level alone.
  for (const auto& [right, down, most] :
       {Area{{8, 0}, {0, 8}, 0.035}, {{2, 0}, {0, 8}, 0.035}, {{2, 0}, {0, 14}, 0.075}, {{8, 6}, {5, 5}, 0.035}}) {
    const auto [sampler, mean] = errors(right, down);
    EXPECT_LT(mean, most) << right.x;
    EXPECT_LT(mean, 0.5 * sampler) << right.x;
  }
}

// Where texels are larger than the footprint and have no filter between them.
TEST(FootprintFilter, TheMeanOfNearestTexelsIsExactWithinARectangle) {
  const MipChain checker = chain_of([](std::uint32_t x, std::uint32_t y) { return (x + y) % 2 == 0 ? 255 : 0; });
  Texture nearest;
  nearest.magnify = Filter::nearest;
  Random random(3);
  for (int i = 0; i < 2000; ++i) {
    const float width = random.real32(0.05, 1), height = random.real32(0.05, 1);
    const glm::vec2 at(random.real32(64, 192), random.real32(64, 192));
    ASSERT_NEAR(mean_of(checker, nearest, at, {width, 0}, {0, height}, 4),
                0.5 + 0.5 * mean_of_wave(at.x, width, 1) * mean_of_wave(at.y, height, 1), 2e-3);
  }
}

TEST(FootprintFilter, SkewedSidesBecomeARectangleOfTheSameMoments) {
  Random random(4);
  const glm::vec2 size(64, 32);
  int turned = 0;
  for (int i = 0; i < 2000; ++i) {
    const auto side = [&] { return glm::vec2(random.real32(-1, 1), random.real32(-1, 1)); };
    const TextureSlopes slopes{side(), side()};
    const FootprintSides sides = footprint_sides(slopes, size);
    const glm::vec2 a = sides.along * size, b = sides.across * size, p = slopes.dx * size, q = slopes.dy * size;
    for (const auto& [k, l] : {std::pair{0, 0}, {0, 1}, {1, 1}})
      ASSERT_NEAR(a[k] * a[l] + b[k] * b[l], p[k] * p[l] + q[k] * q[l], 2e-5 * (glm::dot(p, p) + glm::dot(q, q)));
    ASSERT_NEAR(sides.length, glm::length(a), 1e-4);
    if (a == p && b == q) continue;
    ++turned;
    ASSERT_NEAR(glm::dot(a, b), 0, 2e-5 * (glm::dot(a, a) + glm::dot(b, b)));
  }
  EXPECT_GT(turned, 500);
}

TEST(FootprintFilter, WhateverTheFootprintTheColorIsWithinTheImages) {
  Random random(5);
  const MipChain chain = make_mip_chain(random_image(random, 6, 9), ColorSpace::srgb);
  const float kHard[] = {std::numeric_limits<float>::quiet_NaN(),
                         std::numeric_limits<float>::infinity(),
                         -std::numeric_limits<float>::infinity(),
                         3e38f,
                         1e20f,
                         -16777216.0f,
                         1e-40f,
                         -1e-9f,
                         0.0f,
                         0.3f,
                         -1.0f,
                         7.0f};
  for (const int taps : {1, 4, 16})
    for (const Filter magnify : {Filter::nearest, Filter::linear})
      for (const float a : kHard)
        for (const float b : kHard)
          for (const float c : kHard) {
            const FilterPlan plan = footprint_plan(chain, {.magnify = magnify}, {{a, b}, {c, a}}, taps);
            ASSERT_LE(plan.texels(), 4u * static_cast<unsigned>(taps));
            const glm::vec4 found = filtered(chain, {}, {c, b}, plan, kIgnored);
            for (int i = 0; i < 4; ++i)
              ASSERT_TRUE(found[i] >= 0 && found[i] <= 1.000001f) << a << ' ' << b << ' ' << c;
          }
}

}  // namespace beampipe::footprint_filter_test
