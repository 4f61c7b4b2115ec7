#include "simd/touched_pixels.h"

#include "tests/simd/every_target.h"
#include "tests/simd/random.h"

namespace beampipe::touched_pixels_test {

constexpr std::uint64_t kUpperLeft = 1;  // pixel of the first quad

// Depth grows by 1/64 per pixel to the right and falls by 1/32 per pixel down. At the centre of pixel (6, 3) it is
// -1/2 + 2.5/64 - 1.5/32 = -65/128, and half a pixel away by up to 3/128 more or less.
TEST(TouchedPixels, HaveBounds) {
  const AnchoredPlane<double> plane{-0.5, 1.0 / 64, -1.0 / 32, 4, 2};
  const PixelRow row{6, 3, 0, {kUpperLeft, 0}};
  on_every_target([&] {
    TouchedPixels pixels;
    ASSERT_EQ(touched_pixels(&row, 1, plane, {-1.0f, 0.0f}, pixels), 1u);
    EXPECT_EQ(pixels.nearest[0], -68.0f / 128);
    EXPECT_EQ(pixels.farthest[0], -62.0f / 128);
    touched_pixels(&row, 1, plane, {-67.0f / 128, -63.0f / 128}, pixels);
    EXPECT_EQ(pixels.nearest[0], -67.0f / 128) << "no nearer than the vertices";
    EXPECT_EQ(pixels.farthest[0], -63.0f / 128) << "no farther than the vertices";
  });
}

// Third and fourth pixel of quad 9, first of quad 10, and last of the row, which is in quad 9 + 15.
TEST(TouchedPixels, AreInTheOrderOfBits) {
  const PixelRow rows[2] = {{10, 20, 9, {0b1'1100 | std::uint64_t{1} << 63, 0b1000}}, {0, 22, 30, {0b10, 0b10}}};
  on_every_target([&] {
    TouchedPixels pixels;
    ASSERT_EQ(touched_pixels(rows, 2, {}, {-1.0f, 0.0f}, pixels), 5u);
    const std::int32_t x[] = {10, 11, 12, 41, 1}, y[] = {21, 21, 20, 21, 22};
    const std::uint32_t quad[] = {9, 9, 10, 24, 30};
    const bool full[] = {false, true, false, false, true};
    for (std::size_t i = 0; i < 5; ++i) {
      EXPECT_EQ(pixels.x[i], x[i]) << i;
      EXPECT_EQ(pixels.y[i], y[i]) << i;
      EXPECT_EQ(pixels.quad[i], quad[i]) << i;
      EXPECT_EQ(pixels.full[i] != 0, full[i]) << i;
    }
  });
}

// As many as there can be, on a plane without rounding: depths are multiples of 2^-20.
TEST(TouchedPixels, FillBlocks) {
  Random random(65);
  on_every_target([&] {
    for (int round = 0; round < 200; ++round) {
      PixelRow rows[kRowsInBlock];
      for (PixelRow& row : rows) {
        const std::uint64_t touched = round == 0 ? ~std::uint64_t{0} : random.bits() & random.bits();
        row = {
            2 * random.int32(0, 500), 2 * random.int32(0, 500), random.word() >> 1, {touched, touched & random.bits()}};
      }
      // Slopes are even, so that half a pixel is a whole number.
      const std::int64_t z = random.integer(-(1 << 20), 0), dzdx = 2 * random.integer(-50, 50),
                         dzdy = 2 * random.integer(-50, 50), x = random.integer(0, 999), y = random.integer(0, 999);
      const std::int64_t nearest = z - random.integer(0, 2'000), farthest = z + random.integer(0, 2'000);
      const auto depth = [](std::int64_t units) { return static_cast<double>(units) * 0x1p-20; };
      TouchedPixels pixels;
      const std::size_t count = touched_pixels(
          rows, kRowsInBlock, {depth(z), depth(dzdx), depth(dzdy), static_cast<double>(x), static_cast<double>(y)},
          {static_cast<float>(depth(nearest)), static_cast<float>(depth(farthest))}, pixels);
      const std::int64_t reach = (std::abs(dzdx) + std::abs(dzdy)) / 2;
      std::size_t i = 0;
      for (const PixelRow& row : rows) {
        for (std::int32_t bit = 0; bit < 64; ++bit) {
          if ((row.pixels.touched >> bit & 1) == 0) continue;
          const std::int32_t at_x = row.x + bit / 4 * 2 + bit % 2, at_y = row.y + bit % 4 / 2;
          const std::int64_t centre = z + (dzdx * (2 * (at_x - x) + 1) + dzdy * (2 * (at_y - y) + 1)) / 2;
          ASSERT_EQ(pixels.x[i], at_x);
          ASSERT_EQ(pixels.y[i], at_y);
          ASSERT_EQ(pixels.quad[i], row.quad + static_cast<std::uint32_t>(bit / 4));
          ASSERT_EQ(pixels.full[i] != 0, (row.pixels.full >> bit & 1) != 0);
          ASSERT_EQ(pixels.nearest[i], static_cast<float>(depth(std::clamp(centre - reach, nearest, farthest))));
          ASSERT_EQ(pixels.farthest[i], static_cast<float>(depth(std::clamp(centre + reach, nearest, farthest))));
          ++i;
        }
      }
      ASSERT_EQ(count, i);
    }
  });
}

// The same bits also where arithmetic rounds.
TEST(TouchedPixels, HaveTheBoundsOfTheFormulaOnEveryTarget) {
  Random random(66);
  on_every_target([&] {
    for (int round = 0; round < 2'000; ++round) {
      const double steepness = std::ldexp(1.0, static_cast<int>(random.integer(-30, 4)));
      const AnchoredPlane<double> plane{random.real(-1, 0), random.real(-1, 1) * steepness,
                                        random.real(-1, 1) * steepness, random.real(-99, 999), random.real(-99, 999)};
      const float z = random.real32(-1, 0);
      const DepthBounds<float> vertices{z, random.real32(z, 0)};
      const PixelRow row{2 * random.int32(0, 8'000), 2 * random.int32(0, 8'000), 0, {random.bits(), 0}};
      TouchedPixels pixels;
      const std::size_t count = touched_pixels(&row, 1, plane, vertices, pixels);
      for (std::size_t i = 0; i < count; ++i) {
        const auto centre = static_cast<float>(depth_at(plane, pixels.x[i] + 0.5, pixels.y[i] + 0.5));
        const DepthBounds<float> expected =
            pair_bounds<float>({centre, static_cast<float>(plane.dzdx), static_cast<float>(plane.dzdy)}, vertices);
        ASSERT_EQ(pixels.nearest[i], expected.nearest) << round;
        ASSERT_EQ(pixels.farthest[i], expected.farthest) << round;
      }
    }
  });
}

}  // namespace beampipe::touched_pixels_test
