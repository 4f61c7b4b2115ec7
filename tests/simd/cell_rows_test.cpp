#include "simd/cell_rows.h"

#include "tests/simd/every_target.h"
#include "tests/simd/random.h"

namespace beampipe::cell_rows_test {

// Edges of all slopes. Many of them pass exactly through a corner of a cell.
EdgeOverCells random_edge(Random& random) {
  const auto slope = [&] {
    return random.integer(-1, 1) * random.integer(0, std::int64_t{1} << random.integer(0, 32));
  };
  const std::int64_t right = slope(), down = slope();
  EdgeOverCells edge;
  edge.step = static_cast<double>(right), edge.down = static_cast<double>(down);
  edge.deepest = static_cast<double>(std::max<std::int64_t>(right, 0) + std::max<std::int64_t>(down, 0));
  edge.shallowest = static_cast<double>(std::min<std::int64_t>(right, 0) + std::min<std::int64_t>(down, 0));
  edge.start =
      static_cast<double>(-right * random.integer(-1, 33) - down * random.integer(0, 1) + random.integer(-1, 1));
  if (random.one_in(4))
    edge.start = static_cast<double>(random.integer(-(std::int64_t{1} << 50), std::int64_t{1} << 50));
  return edge;
}

TEST(CellRows, KernelEqualsTwin) {
  Random random(64);
  on_every_target([&] {
    for (int i = 0; i < 20'000; ++i) {
      const EdgeOverCells edges[3] = {random_edge(random), random_edge(random), random_edge(random)};
      const auto count = static_cast<std::size_t>(random.integer(1, kCellsPerRow));
      const CellRows found = cell_rows(edges, count), expected = cell_rows_scalar(edges, count);
      for (int j = 0; j < 2; ++j) {
        ASSERT_EQ(found.rows[j].touched, expected.rows[j].touched) << "pair " << i << ", row " << j << ", " << count;
        ASSERT_EQ(found.rows[j].full, expected.rows[j].full) << "pair " << i << ", row " << j << ", " << count;
      }
    }
  });
}

}  // namespace beampipe::cell_rows_test
