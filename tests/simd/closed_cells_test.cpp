#include "simd/closed_cells.h"

#include "simd/quad_rows.h"
#include "tests/simd/every_target.h"
#include "tests/simd/random.h"

namespace beampipe::closed_cells_test {

constexpr int kColumns = 2 * kQuadsPerRow;

std::vector<float> depths_of_row(Random& random) {
  std::vector<float> depths(kColumns + kClosedSlack);
  for (float& depth : depths) depth = random.pick(std::vector{-0.75f, -0.5f, -0.25f, 1.0f});
  return depths;
}

TEST(ClosedCells, KernelEqualsOneCellAfterTheOther) {
  Random random(7);
  on_every_target([&] {
    for (int i = 0; i < 3'000; ++i) {
      const std::int64_t first = random.integer(0, 63), last = random.integer(first, 63);
      const std::uint64_t range = ~std::uint64_t{0} << first & ~std::uint64_t{0} >> (63 - last);
      const std::uint64_t touched = (random.bits() & range) | std::uint64_t{1} << first;
      const ClosingRow row{touched, touched & random.bits(), random.pick(std::vector{-1.0f, -0.5f, -0.375f}),
                           random.pick(std::vector{-0.375f, -0.25f, 0.0f}), random.pick(std::vector{-0.25f, 1.0f})};
      const std::vector<float> before[2] = {depths_of_row(random), depths_of_row(random)};
      std::vector<float> after[2] = {before[0], before[1]};
      const ClosedCells found = close_cells(row, after[0].data(), after[1].data());

      std::uint32_t tested = 0, hidden = 0, closed = 0, changed = 0, from_farthest = 0;
      for (int x = 0; x < kColumns; ++x) {
        for (int y = 0; y < 2; ++y) {
          const int bit = 4 * (x / 2) + 2 * y + x % 2;
          const float depth = before[y][static_cast<std::size_t>(x)];
          const bool is_touched = row.touched >> bit & 1, is_hidden = is_touched && depth < row.nearest;
          const bool closes = row.covered >> bit & 1 && !is_hidden, changes = closes && row.farthest < depth;
          tested += is_touched, hidden += is_hidden, closed += closes, changed += changes;
          from_farthest += changes && depth == row.farthest_of_closed;
          ASSERT_EQ(found.hidden >> bit & 1, is_hidden) << "row " << i << ", cell " << x << "," << y;
          ASSERT_EQ(after[y][static_cast<std::size_t>(x)], changes ? row.farthest : depth)
              << "row " << i << ", cell " << x << "," << y;
        }
      }
      for (int y = 0; y < 2; ++y)
        for (std::size_t x = kColumns; x < before[y].size(); ++x)
          ASSERT_EQ(after[y][x], before[y][x]) << "beyond the row";
      ASSERT_EQ(found.tested, tested);
      ASSERT_EQ(found.hidden_count, hidden);
      ASSERT_EQ(found.closed, closed);
      ASSERT_EQ(found.changed, changed);
      ASSERT_EQ(found.changed_from_farthest, from_farthest);
    }
  });
}

// Rows of a narrow tile follow each other in memory closer than the kernel reaches.
TEST(ClosedCells, RowsMayFollowEachOther) {
  on_every_target([] {
    std::vector<float> depths(4 + kClosedSlack, -0.5f);
    const ClosedCells found = close_cells({0b1111, 0b1111, -0.75f, -0.625f, -0.5f}, &depths[0], &depths[2]);
    EXPECT_EQ(found.changed_from_farthest, 4u);
    for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(depths[i], -0.625f) << i;
    for (std::size_t i = 4; i < depths.size(); ++i) EXPECT_EQ(depths[i], -0.5f) << i;
  });
}

}  // namespace beampipe::closed_cells_test
