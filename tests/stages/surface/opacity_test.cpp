// Ranks of positions: how many a surface takes, and how many two surfaces share.
#include "stages/surface/opacity.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "tests/simd/random.h"

namespace beampipe {
namespace {

constexpr std::uint32_t kPositions = 256;

TEST(Opacity, RanksAreDifferentAndInRange) {
  for (std::uint32_t draw = 0; draw < 20; ++draw) {
    const OpacityRanks ranks(draw, 3, 5);
    std::set<float> found;
    for (std::uint32_t p = 0; p < kPositions; ++p) {
      EXPECT_TRUE(ranks.rank(p) >= 0 && ranks.rank(p) < 256);
      found.insert(ranks.rank(p));
    }
    EXPECT_EQ(found.size(), kPositions);
  }
}

TEST(Opacity, OpaqueTakesAllAndClearNone) {
  Random random(1);
  for (int i = 0; i < 100; ++i) {
    const OpacityRanks ranks(random.word(), random.int32(0, 16383), random.int32(0, 16383));
    for (std::uint32_t p = 0; p < kPositions; ++p) {
      EXPECT_TRUE(ranks.takes(p, 1));
      EXPECT_FALSE(ranks.takes(p, 0));
    }
  }
}

std::uint32_t taken(const OpacityRanks& ranks, float opacity, std::uint32_t positions = kPositions) {
  std::uint32_t count = 0;
  for (std::uint32_t p = 0; p < positions; ++p) count += ranks.takes(p, opacity);
  return count;
}

TEST(Opacity, TakesItsPartOfThePositions) {
  Random random(2);
  for (int i = 0; i < 2'000; ++i) {
    const OpacityRanks ranks(random.word(), random.int32(0, 16383), random.int32(0, 16383));
    const float opacity = random.real32(0, 1);
    for (const std::uint32_t positions : {32u, 64u, 128u, 256u})  // the sequence is even for every power of two
      ASSERT_LE(std::abs(double{opacity} * positions - taken(ranks, opacity, positions)), 1.0);
  }
}

// Every position is as likely as any other, so that the mean over pixels is the opacity, also in a part of the pixel.
TEST(Opacity, OverPixelsEachPositionIsTakenAsOftenAsOpacitySays) {
  constexpr int kPixels = 4096;
  for (std::uint32_t draw : {0u, 1u, 7u, 15u, 16u, 1000u})
    for (const float opacity : {0.1f, 0.5f, 0.875f}) {
      std::vector<int> times(kPositions);
      for (int i = 0; i < kPixels; ++i) {
        const OpacityRanks ranks(draw, i % 64, i / 64);
        for (std::uint32_t p = 0; p < kPositions; ++p) times[p] += ranks.takes(p, opacity);
      }
      // 256 positions, each a sum of independent trials: five standard deviations.
      const double deviation = std::sqrt(kPixels * opacity * (1 - opacity));
      for (const int t : times) EXPECT_NEAR(t, kPixels * opacity, 5 * deviation) << draw;
    }
}

// Two surfaces: of what the first leaves, the second takes its part. With opacities k / 8, only the three leading bits
// of each rank matter, and 4 positions have given bits in both if these six bits are independent of each other. A
// relation between them adds to that, for every pair of bits, 4 times a product of two Walsh functions, whose sums over
// ranks up to k / 8 are at most 4, 2 or 1, as a leading, second or third bit comes first in them. Flips of ranks change
// its sign alone. No two dimensions have a relation that begins with a leading bit: the error is at most 4 x 2 x 2
// positions. Only dimensions 7 and 15 come that far.
TEST(Opacity, SurfacesAreIndependentOfEachOther) {
  std::size_t exact = 0;
  for (std::uint32_t a = 0; a < kOpacityDimensions; ++a)
    for (std::uint32_t b = 0; b < a; ++b) {
      double worst = 0;
      for (int pixel = 0; pixel < 16; ++pixel) {
        const OpacityRanks first(a, pixel, 0), second(b, pixel, 0);
        for (int i = 1; i < 8; ++i)
          for (int j = 1; j < 8; ++j) {
            int both = 0;
            for (std::uint32_t p = 0; p < kPositions; ++p)
              both += first.takes(p, static_cast<float>(i) / 8) && second.takes(p, static_cast<float>(j) / 8);
            worst = std::max(worst, std::abs(both - i * j * 4.0));
          }
      }
      exact += worst == 0;
      EXPECT_LE(worst, a == 15 && b == 7 ? 16 : 8) << "dimensions " << b << " and " << a;
    }
  EXPECT_EQ(exact, 108u);  // of 120 pairs
}

}  // namespace
}  // namespace beampipe
