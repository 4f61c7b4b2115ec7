#include "simd/sample_pattern.h"

#include <span>
#include <stdexcept>
#include <string>

namespace beampipe {
namespace {

struct Position {
  int x, y;  // 1/16 px from the pixel's centre
};

constexpr Position kStandard1[] = {{0, 0}};
constexpr Position kStandard2[] = {{4, 4}, {-4, -4}};
constexpr Position kStandard4[] = {{-2, -6}, {6, -2}, {-6, 2}, {2, 6}};
constexpr Position kStandard8[] = {{1, -3}, {-1, 3}, {5, 1}, {-3, -5}, {-5, 5}, {-7, -1}, {3, 7}, {7, -7}};
constexpr Position kStandard16[] = {{1, 1},  {-1, -3}, {-3, 2},  {4, -1}, {-5, -2}, {2, 5},  {5, 3}, {3, -5},
                                    {-2, 6}, {0, -7},  {-4, -6}, {-6, 4}, {-8, 0},  {7, -4}, {6, 7}, {-7, -8}};

std::span<const Position> standard_positions(int count) {
  switch (count) {
    case 1:
      return kStandard1;
    case 2:
      return kStandard2;
    case 4:
      return kStandard4;
    case 8:
      return kStandard8;
    case 16:
      return kStandard16;
    default:
      throw std::invalid_argument("expected 1, 2, 4, 8 or 16 samples, found " + std::to_string(count));
  }
}

}  // namespace

SamplePattern standard_pattern(int count, int cell_width, int cell_height) {
  SamplePattern pattern;
  for (const Position& position : standard_positions(count)) {
    const auto i = static_cast<std::size_t>(pattern.count++);
    pattern.x[i] = (position.x + 8) * cell_width / 16;
    pattern.y[i] = (position.y + 8) * cell_height / 16;
  }
  return pattern;
}

int squared_distance_to_centre(const SamplePattern& pattern, std::size_t sample) {
  const int x = pattern.x[sample] - kSubpixelUnits / 2, y = pattern.y[sample] - kSubpixelUnits / 2;
  return x * x + y * y;
}

std::size_t nearest_to_centre(const SamplePattern& pattern) {
  std::size_t nearest = 0;
  for (std::size_t s = 1; s < static_cast<std::size_t>(pattern.count); ++s)
    if (squared_distance_to_centre(pattern, s) < squared_distance_to_centre(pattern, nearest)) nearest = s;
  return nearest;
}

SamplePattern only(const SamplePattern& pattern, std::size_t sample) {
  SamplePattern one;
  one.count = 1;
  one.x[0] = pattern.x[sample], one.y[0] = pattern.y[sample];
  return one;
}

CellCounts split_into_cells(int cells) {
  CellCounts counts;
  for (; cells > 1; cells /= 2) (counts.columns <= counts.rows ? counts.columns : counts.rows) *= 2;
  return counts;
}

std::vector<SamplePattern> cell_patterns(int count) {
  if (count != 32 && count != 64 && count != 128 && count != 256)
    throw std::invalid_argument("expected 32, 64, 128 or 256 positions, found " + std::to_string(count));
  const CellCounts cells = split_into_cells(count / 8);
  const int width = kSubpixelUnits / cells.columns, height = kSubpixelUnits / cells.rows;
  const SamplePattern cell = standard_pattern(8, width, height);
  std::vector<SamplePattern> patterns(static_cast<std::size_t>(count / kMaxMaskSamples));
  for (int i = 0; i < count; ++i) {
    const auto in_cell = static_cast<std::size_t>(i % 8);
    const int column = i / 8 % cells.columns, row = i / 8 / cells.columns;
    SamplePattern& pattern = patterns[static_cast<std::size_t>(i / kMaxMaskSamples)];
    const auto at = static_cast<std::size_t>(pattern.count++);
    pattern.x[at] = column * width + cell.x[in_cell];
    pattern.y[at] = row * height + cell.y[in_cell];
  }
  return patterns;
}

SamplePattern hammersley_pattern() {
  SamplePattern pattern;
  pattern.count = 32;
  for (int i = 0; i < 32; ++i) {
    int reversed = 0;
    for (int bit = 0; bit < 5; ++bit) reversed |= ((i >> bit) & 1) << (4 - bit);
    pattern.x[static_cast<std::size_t>(i)] = i * 8 + 4;
    pattern.y[static_cast<std::size_t>(i)] = reversed * 8 + 4;
  }
  return pattern;
}

}  // namespace beampipe
