#include "simd/depth_bounds.h"

#include "tests/simd/every_target.h"
#include "tests/simd/random.h"

namespace beampipe::depth_bounds_test {

// Depth grows by 1/64 per pixel to the right and falls by 1/32 per pixel down. At the centre of pixel (6, 3) it is
// -1/2 + 2.5/64 - 1.5/32 = -65/128, and half a pixel away by up to 3/128 more or less.
TEST(DepthBounds, OfOnePixel) {
  const AnchoredPlane<double> plane{-0.5, 1.0 / 64, -1.0 / 32, 4, 2};
  on_every_target([&] {
    PixelBounds pixels;
    pixels.x[0] = 6, pixels.y[0] = 3;
    find_pair_bounds(plane, {-1.0f, 0.0f}, 1, pixels);
    EXPECT_EQ(pixels.nearest[0], -68.0f / 128);
    EXPECT_EQ(pixels.farthest[0], -62.0f / 128);
    find_pair_bounds(plane, {-67.0f / 128, -63.0f / 128}, 1, pixels);
    EXPECT_EQ(pixels.nearest[0], -67.0f / 128) << "no nearer than the vertices";
    EXPECT_EQ(pixels.farthest[0], -63.0f / 128) << "no farther than the vertices";
  });
}

// On multiples of a power of two the arithmetic is exact, and so is that of integers. All depths are in 2^-20.
TEST(DepthBounds, EqualIntegerArithmetic) {
  Random random(65);
  constexpr double kUnit = 0x1p-20;
  on_every_target([&] {
    for (int i = 0; i < 2'000; ++i) {
      // Slopes are even, so that half a pixel is a whole number.
      const std::int64_t z = random.integer(-(1 << 20), 0), dzdx = 2 * random.integer(-50, 50),
                         dzdy = 2 * random.integer(-50, 50), x = random.integer(0, 999), y = random.integer(0, 999);
      const std::int64_t nearest = z - random.integer(0, 2'000), farthest = z + random.integer(0, 2'000);
      const auto depth = [](std::int64_t units) { return static_cast<double>(units) * kUnit; };
      const AnchoredPlane<double> plane{depth(z), depth(dzdx), depth(dzdy), static_cast<double>(x),
                                        static_cast<double>(y)};
      const auto count = static_cast<std::size_t>(random.integer(1, kBoundsBlock));
      PixelBounds pixels;
      for (std::size_t p = 0; p < count; ++p) pixels.x[p] = random.int32(0, 999), pixels.y[p] = random.int32(0, 999);
      find_pair_bounds(plane, {static_cast<float>(depth(nearest)), static_cast<float>(depth(farthest))}, count, pixels);
      const std::int64_t reach = (std::abs(dzdx) + std::abs(dzdy)) / 2;
      for (std::size_t p = 0; p < count; ++p) {
        const std::int64_t centre = z + (dzdx * (2 * (pixels.x[p] - x) + 1) + dzdy * (2 * (pixels.y[p] - y) + 1)) / 2;
        ASSERT_EQ(pixels.nearest[p], static_cast<float>(depth(std::clamp(centre - reach, nearest, farthest)))) << i;
        ASSERT_EQ(pixels.farthest[p], static_cast<float>(depth(std::clamp(centre + reach, nearest, farthest)))) << i;
      }
    }
  });
}

// The same bits also where both round.
TEST(DepthBounds, EqualTheFormulaOnEveryTarget) {
  Random random(66);
  on_every_target([&] {
    for (int i = 0; i < 2'000; ++i) {
      const double steepness = std::ldexp(1.0, static_cast<int>(random.integer(-30, 4)));
      const AnchoredPlane<double> plane{random.real(-1, 0), random.real(-1, 1) * steepness,
                                        random.real(-1, 1) * steepness, random.real(-99, 999), random.real(-99, 999)};
      const float z = random.real32(-1, 0);
      const DepthBounds<float> vertices{z, random.real32(z, 0)};
      PixelBounds pixels;
      for (std::size_t p = 0; p < kBoundsBlock; ++p)
        pixels.x[p] = random.int32(0, 16'383), pixels.y[p] = random.int32(0, 16'383);
      find_pair_bounds(plane, vertices, kBoundsBlock, pixels);
      for (std::size_t p = 0; p < kBoundsBlock; ++p) {
        const auto centre = static_cast<float>(depth_at(plane, pixels.x[p] + 0.5, pixels.y[p] + 0.5));
        const DepthBounds<float> expected =
            pair_bounds<float>({centre, static_cast<float>(plane.dzdx), static_cast<float>(plane.dzdy)}, vertices);
        ASSERT_EQ(pixels.nearest[p], expected.nearest) << i;
        ASSERT_EQ(pixels.farthest[p], expected.farthest) << i;
      }
    }
  });
}

}  // namespace beampipe::depth_bounds_test
