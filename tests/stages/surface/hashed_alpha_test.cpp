// Thresholds of hashed alpha.
#include "stages/surface/hashed_alpha.h"

#include "tests/simd/random.h"
#include "tests/test.h"

namespace beampipe::hashed_alpha_test {

using Pair = std::array<float, 2>;

// A pixel of `side` in both directions.
float threshold(float u, float v, float side) { return hashed_threshold<float>({u, v}, {side, 0.0f}, {0.0f, side}); }

// The part of thresholds below t is t: between two sizes of cells, in the middle and near either one.
TEST(HashedAlpha, IsEven) {
  for (const float side : {1 / 64.0f, 1 / 68.0f, 1 / 90.0f, 1 / 96.0f, 1 / 127.0f}) {
    std::vector<float> found;
    for (int y = 0; y < 200; ++y)
      for (int x = 0; x < 200; ++x)
        found.push_back(threshold(static_cast<float>(x) * 0.37f, static_cast<float>(y) * 0.41f, side));
    std::ranges::sort(found);
    const auto count = static_cast<double>(found.size());
    for (std::size_t i = 0; i < found.size(); ++i)
      ASSERT_NEAR(found[i], static_cast<double>(i) / count, 0.02) << side;  // 40,000 values: 3 sigma is 0.0075
  }
}

// Within a cell it is the same, and it does not depend on where the pixel lies.
TEST(HashedAlpha, MovesWithTheSurface) {
  EXPECT_EQ(threshold(3.1f, 2.1f, 0.5f), threshold(3.4f, 2.4f, 0.5f));  // cells of 1/2, and of 1/4 with weight 0
  EXPECT_NE(threshold(3.1f, 2.1f, 0.5f), threshold(3.6f, 2.1f, 0.5f));
}

// Half a step nearer, only cells of half the size count; on the way there nothing jumps.
TEST(HashedAlpha, PassesFromSizeToSize) {
  EXPECT_NEAR(threshold(3.1f, 2.1f, std::nextafter(0.25f, 1.0f)), threshold(3.1f, 2.1f, 0.25f), 1e-5);
  float before = threshold(3.1f, 2.1f, 0.5f);
  for (int i = 1; i <= 1000; ++i) {
    const float now = threshold(3.1f, 2.1f, 0.5f / (1 + static_cast<float>(i) / 1000));
    EXPECT_NEAR(now, before, 0.01);
    before = now;
  }
}

TEST(HashedAlpha, TakesAnyNumbers) {
  const float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
  for (const float u : {0.0f, 1e30f, -1e30f, nan, infinity})
    for (const float side : {0.0f, 1e-30f, 1e30f, nan, infinity}) {
      const float found = threshold(u, u, side);
      EXPECT_TRUE(found >= 0 && found <= 1) << u << ' ' << side << ' ' << found;
    }
}

}  // namespace beampipe::hashed_alpha_test
