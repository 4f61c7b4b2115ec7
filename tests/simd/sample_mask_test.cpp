#include "simd/sample_mask.h"

#include "tests/simd/every_target.h"
#include "tests/simd/random.h"

namespace beampipe::sample_mask_test {

std::uint32_t twin(const CellEdges& cell, const SamplePattern& pattern) {
  std::int64_t a[3], b[3];
  for (int k = 0; k < 3; ++k) a[k] = cell.a[k], b[k] = cell.b[k];
  return sample_mask_scalar<std::int64_t>(a, b, cell.c, pattern);
}

void expect_kernel_equals_twin(const std::vector<CellEdges>& cells, const SamplePattern& pattern) {
  on_every_target([&] {
    std::vector<std::uint32_t> masks(cells.size(), 0xdeadbeef);
    sample_masks(cells.data(), cells.size(), pattern, masks.data());
    for (std::size_t i = 0; i < cells.size(); ++i)
      ASSERT_EQ(masks[i], twin(cells[i], pattern)) << "cell " << i << ", " << pattern.count << " samples";
  });
}

SamplePattern random_pattern(Random& random, int count) {
  SamplePattern pattern;
  pattern.count = count;
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i)
    pattern.x[i] = random.int32(0, 255), pattern.y[i] = random.int32(0, 255);
  return pattern;
}

// Slopes of every size, many of them at the limit where the kernel changes its number type. Edges pass exactly through
// a sample or miss it by one unit.
CellEdges random_edges(Random& random, const SamplePattern& pattern) {
  constexpr std::int32_t kBorder = 1 << 20, kLargest = 1 << 24;
  constexpr std::int32_t kSpecial[] = {0, 1, kBorder - 1, kBorder, kBorder + 1, kLargest};
  constexpr std::int64_t kDecided = 1 << 30, kHighest = (std::int64_t{1} << 52) - 1;
  constexpr std::int64_t kExtremes[] = {kHighest, kDecided, kDecided + 1, kDecided - 1, (std::int64_t{1} << 31), 1, 0};
  const auto slope = [&] {
    const std::int32_t magnitude =
        random.one_in(3) ? random.pick(kSpecial) : random.int32(0, (1 << random.int32(0, 24)) - 1);
    return random.one_in(2) ? magnitude : -magnitude;
  };
  CellEdges cell;
  for (int k = 0; k < 3; ++k) {
    cell.a[k] = slope(), cell.b[k] = slope();
    const auto s = static_cast<std::size_t>(random.integer(0, pattern.count - 1));
    const std::int64_t through = -(std::int64_t{cell.a[k]} * pattern.x[s] + std::int64_t{cell.b[k]} * pattern.y[s]);
    cell.c[k] = through + random.integer(-1, 1);
    if (random.one_in(5)) cell.c[k] = random.pick(kExtremes) * (random.one_in(3) ? -1 : 1);
  }
  return cell;
}

TEST(SampleMask, KernelEqualsTwinForEveryPatternSize) {
  Random random(21);
  for (int count = 1; count <= kMaxMaskSamples; ++count) {
    const SamplePattern pattern = random_pattern(random, count);
    std::vector<CellEdges> cells;
    for (int i = 0; i < 3'000; ++i) cells.push_back(random_edges(random, pattern));
    expect_kernel_equals_twin(cells, pattern);
  }
}

// Cells of a grid, of several triangles in a row.
struct GridCells {
  std::vector<GridEdges> edges;
  std::vector<GridCell> cells;
  std::vector<std::uint32_t> expected;
};

// Edges pass exactly through a sample of a cell far from the origin, or miss it by one unit.
void add_triangle(Random& random, const SamplePattern& pattern, GridCells& grid) {
  constexpr std::int64_t kFar = 1 << 15;
  const std::int64_t width = std::int64_t{16} << random.integer(0, 4),
                     height = std::int64_t{16} << random.integer(0, 4);
  const std::int64_t x = random.integer(0, kFar), y = random.integer(0, kFar);
  std::int64_t a[3], b[3], start[3];
  GridEdges edges;
  for (int k = 0; k < 3; ++k) {
    const std::int32_t largest = 1 << random.int32(0, 24);
    a[k] = random.integer(-largest, largest), b[k] = random.integer(-largest, largest);
    const auto s = static_cast<std::size_t>(random.integer(0, pattern.count - 1));
    start[k] = random.integer(-1, 1) - a[k] * (width * x + pattern.x[s]) - b[k] * (height * y + pattern.y[s]);
    edges.a[k] = static_cast<double>(a[k]), edges.b[k] = static_cast<double>(b[k]);
    edges.right[k] = static_cast<double>(a[k] * width), edges.down[k] = static_cast<double>(b[k] * height);
    edges.start[k] = static_cast<double>(start[k]);
  }
  for (std::int64_t cells = random.integer(1, 5); cells > 0; --cells) {
    const std::int64_t column = x + random.integer(-1, 1), row = y + random.integer(-1, 1);
    std::int64_t corner[3];
    for (int k = 0; k < 3; ++k) corner[k] = start[k] + a[k] * width * column + b[k] * height * row;
    grid.cells.push_back({static_cast<std::uint32_t>(grid.edges.size()), static_cast<std::int32_t>(column),
                          static_cast<std::int32_t>(row)});
    grid.expected.push_back(sample_mask_scalar(a, b, corner, pattern));
  }
  grid.edges.push_back(edges);
}

TEST(SampleMask, GridKernelEqualsTwinForEveryPatternSize) {
  Random random(23);
  for (int count = 1; count <= kMaxMaskSamples; ++count) {
    const SamplePattern pattern = random_pattern(random, count);
    GridCells grid;
    for (int i = 0; i < 500; ++i) add_triangle(random, pattern, grid);
    std::uint64_t samples = 0;
    for (const std::uint32_t mask : grid.expected) samples += static_cast<std::uint64_t>(std::popcount(mask));
    on_every_target([&] {
      std::vector<std::uint32_t> masks(grid.cells.size(), 0xdeadbeef);
      EXPECT_EQ(sample_masks(grid.edges.data(), grid.cells.data(), grid.cells.size(), pattern, masks.data()), samples);
      ASSERT_EQ(masks, grid.expected) << count << " samples";
    });
  }
}

}  // namespace beampipe::sample_mask_test
