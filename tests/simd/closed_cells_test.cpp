#include "simd/closed_cells.h"

#include "simd/quad_rows.h"
#include "tests/simd/every_target.h"
#include "tests/simd/random.h"

namespace beampipe::closed_cells_test {

// The depths of a tile that has `width` x `height` cells, and what may be read beyond it.
std::vector<float> random_depths(Random& random, std::int32_t width, std::int32_t height) {
  std::vector<float> depths(static_cast<std::size_t>(width * height) + kClosedSlack);
  for (float& depth : depths) depth = random.pick(std::vector{-0.75f, -0.5f, -0.25f, 1.0f});
  return depths;
}

// Two rows of a triangle, in tiles of all widths up to that of a row. The last row of quads may have no lower cells.
TEST(ClosedCells, KernelEqualsOneCellAfterTheOther) {
  Random random(7);
  on_every_target([&] {
    for (int i = 0; i < 3'000; ++i) {
      SCOPED_TRACE(i);
      const std::int32_t width = random.int32(1, 2 * kQuadsPerRow), height = random.int32(3, 4);
      const std::vector<float> before = random_depths(random, width, height);
      std::vector<float> after = before;
      const float farthest_of_tile = random.pick(std::vector{-0.25f, 1.0f});
      const ClosingTriangle triangle{random.pick(std::vector{-1.0f, -0.5f, -0.375f}),
                                     random.pick(std::vector{-0.375f, -0.25f, 0.0f}), !random.one_in(4)};
      const std::int32_t left = random.int32(0, (width - 1) / 2) * 2;
      ClosingRow rows[2];
      for (std::int32_t row = 0; row < 2; ++row) {
        std::uint64_t inside = 0;
        for (int bit = 0; bit < 64; ++bit)
          if (left + bit / 4 * 2 + bit % 2 < width && 2 * row + bit / 2 % 2 < height) inside |= std::uint64_t{1} << bit;
        const std::uint64_t touched = (random.bits() & inside) | 1;
        rows[row] = {10 + left, 20 + 2 * row, touched, touched & random.bits()};
      }
      const ClosingRow given[2] = {rows[0], rows[1]};
      const ClosedCells found =
          close_cells(triangle, {10, 20, 10 + width, 20 + height, after.data(), farthest_of_tile}, rows, 2);

      ClosedCells expected{};
      std::vector<float> closed = before;
      for (std::int32_t row = 0; row < 2; ++row) {
        for (int bit = 0; bit < 64; ++bit) {
          if (!(given[row].visible >> bit & 1)) {
            ASSERT_EQ(rows[row].visible >> bit & 1, 0u);
            continue;
          }
          const std::int32_t x = left + bit / 4 * 2 + bit % 2, y = 2 * row + bit / 2 % 2;
          float& depth = closed[static_cast<std::size_t>(y * width + x)];
          const bool hidden = depth < triangle.nearest;
          const bool closes = triangle.closes && !hidden && (given[row].full >> bit & 1);
          const bool changes = closes && triangle.farthest < depth;
          ASSERT_EQ(rows[row].visible >> bit & 1, !hidden) << x << "," << y;
          ++expected.tested, expected.hidden += hidden, expected.closed += closes, expected.changed += changes;
          expected.changed_from_farthest += changes && depth == farthest_of_tile;
          if (changes) depth = triangle.farthest;
        }
      }
      ASSERT_EQ(after, closed);
      ASSERT_EQ(found.tested, expected.tested);
      ASSERT_EQ(found.hidden, expected.hidden);
      ASSERT_EQ(found.closed, expected.closed);
      ASSERT_EQ(found.changed, expected.changed);
      ASSERT_EQ(found.changed_from_farthest, expected.changed_from_farthest);
    }
  });
}

}  // namespace beampipe::closed_cells_test
