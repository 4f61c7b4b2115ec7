#include "simd/sample_pattern.h"

#include "tests/test.h"

namespace beampipe::sample_pattern_test {

using Locations = std::vector<std::pair<double, double>>;

// Vulkan 1.3, section "Multisampling", table "Standard sample locations".
const std::map<int, Locations> kVulkan = {
    {1, {{0.5, 0.5}}},
    {2, {{0.75, 0.75}, {0.25, 0.25}}},
    {4, {{0.375, 0.125}, {0.875, 0.375}, {0.125, 0.625}, {0.625, 0.875}}},
    {8,
     {{0.5625, 0.3125},
      {0.4375, 0.6875},
      {0.8125, 0.5625},
      {0.3125, 0.1875},
      {0.1875, 0.8125},
      {0.0625, 0.4375},
      {0.6875, 0.9375},
      {0.9375, 0.0625}}},
    {16,
     {{0.5625, 0.5625},
      {0.4375, 0.3125},
      {0.3125, 0.625},
      {0.75, 0.4375},
      {0.1875, 0.375},
      {0.625, 0.8125},
      {0.8125, 0.6875},
      {0.6875, 0.1875},
      {0.375, 0.875},
      {0.5, 0.0625},
      {0.25, 0.125},
      {0.125, 0.75},
      {0.0, 0.5},
      {0.9375, 0.25},
      {0.875, 0.9375},
      {0.0625, 0.0}}},
};

Locations locations(const SamplePattern& pattern, double width, double height) {
  Locations found;
  for (std::size_t i = 0; i < static_cast<std::size_t>(pattern.count); ++i)
    found.emplace_back(pattern.x[i] / width, pattern.y[i] / height);
  return found;
}

TEST(SamplePattern, StandardLocationsInOrder) {
  for (const auto& [count, expected] : kVulkan) EXPECT_EQ(locations(standard_pattern(count), 256, 256), expected);
}

// Cells down to 1/16 px are scaled without rounding.
TEST(SamplePattern, StandardLocationsInCells) {
  for (const int width : {128, 64, 32, 16})
    for (const int height : {256, 128, 64, 32, 16})
      EXPECT_EQ(locations(standard_pattern(8, width, height), width, height), kVulkan.at(8))
          << width << " x " << height;
}

TEST(SamplePattern, OtherCountsAreRefused) {
  for (const int count : {-1, 0, 3, 5, 32}) EXPECT_THROW(standard_pattern(count), std::invalid_argument) << count;
}

TEST(SamplePattern, HammersleyHasOneSamplePerRowAndColumn) {
  const SamplePattern pattern = hammersley_pattern();
  ASSERT_EQ(pattern.count, 32);
  std::set<int> columns, rows;
  for (std::size_t i = 0; i < 32; ++i) {
    columns.insert(pattern.x[i]);
    rows.insert(pattern.y[i]);
  }
  std::set<int> centers;
  for (int i = 0; i < 32; ++i) centers.insert(8 * i + 4);
  EXPECT_EQ(columns, centers);
  EXPECT_EQ(rows, centers);
}

// The pattern is a (0, 5, 2)-net in base 2: every box of area 1/32 px has one sample, whatever its shape. A diagonal
// pattern would pass the test above, but not this one.
TEST(SamplePattern, HammersleyHasOneSamplePerElementaryBox) {
  const SamplePattern pattern = hammersley_pattern();
  for (int wide = 0; wide <= 5; ++wide) {
    std::set<std::pair<int, int>> boxes;
    for (std::size_t i = 0; i < 32; ++i)
      boxes.emplace(pattern.x[i] * (1 << wide) / 256, pattern.y[i] * (1 << (5 - wide)) / 256);
    EXPECT_EQ(boxes.size(), 32u) << (1 << wide) << " columns";
  }
}

TEST(SamplePattern, MasksHave32To256Positions) {
  EXPECT_THROW(cell_patterns(16), std::invalid_argument);
  EXPECT_THROW(cell_patterns(96), std::invalid_argument);
}

}  // namespace beampipe::sample_pattern_test
