#include "simd/quad_rows.h"

#include "tests/simd/every_target.h"
#include "tests/simd/random.h"

namespace beampipe::quad_rows_test {

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
      static_cast<double>(-right * random.integer(-1, 33) - down * random.integer(-1, 33) + random.integer(-1, 1));
  if (random.one_in(4))
    edge.start = static_cast<double>(random.integer(-(std::int64_t{1} << 50), std::int64_t{1} << 50));
  return edge;
}

// In integers.
bool is_inside(const EdgeOverCells& edge, std::int64_t column, std::int64_t row, double gain) {
  const auto integer = [](double value) { return static_cast<std::int64_t>(value); };
  return integer(edge.start) + integer(edge.step) * column + integer(edge.down) * row + integer(gain) >= 0;
}

TEST(QuadRows, KernelEqualsIntegersCellByCell) {
  Random random(64);
  on_every_target([&] {
    for (int i = 0; i < 2'000; ++i) {
      const EdgeOverCells edges[3] = {random_edge(random), random_edge(random), random_edge(random)};
      const std::int64_t quads = random.integer(1, kQuadsPerRow), rows = random.integer(1, 16);
      QuadRow found[16];
      quad_rows(edges, static_cast<std::size_t>(quads), static_cast<std::size_t>(rows), found);
      for (std::int64_t row = 0; row < rows && quads < kQuadsPerRow; ++row)
        ASSERT_EQ(found[row].touched >> 4 * quads, 0u) << "beyond " << quads << " quads";
      for (std::int64_t y = 0; y < 2 * rows; ++y) {
        for (std::int64_t x = 0; x < 2 * quads; ++x) {
          bool touched = true, full = true;
          for (const EdgeOverCells& edge : edges) {
            touched &= is_inside(edge, x, y, edge.deepest);
            full &= is_inside(edge, x, y, edge.shallowest);
          }
          const std::int64_t bit = 4 * (x / 2) + 2 * (y % 2) + x % 2;
          const QuadRow& row = found[y / 2];
          ASSERT_EQ(row.touched >> bit & 1, touched) << "triangle " << i << ", cell " << x << "," << y;
          ASSERT_EQ(row.full >> bit & 1, touched && full) << "triangle " << i << ", cell " << x << "," << y;
        }
      }
    }
  });
}

}  // namespace beampipe::quad_rows_test
