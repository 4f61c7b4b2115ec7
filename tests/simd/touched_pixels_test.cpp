#include "simd/touched_pixels.h"

#include "tests/simd/every_target.h"
#include "tests/simd/random.h"

namespace beampipe::touched_pixels_test {

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

}  // namespace beampipe::touched_pixels_test
