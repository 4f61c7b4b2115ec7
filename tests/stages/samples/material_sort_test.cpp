#include "stages/samples/material_sort.h"

#include "stages/data/sample_tile.h"
#include "stages/samples/materials.h"
#include "tests/test.h"

namespace beampipe::material_sort_test {

std::vector<std::uint32_t> sorted(const std::vector<std::uint32_t>& triangles, const Materials& materials,
                                  StageCounters& counters) {
  return material_sort(triangles, materials.ids, materials.digits, counters);
}

TEST(MaterialSort, KeepsTheOrderWithinAMaterial) {
  // Triangles 0 to 3 have the materials 2, 0, 1 and 0.
  const Materials materials({2, 0, 1, 0});
  StageCounters counters;
  EXPECT_EQ(sorted({0, kNoTriangle, 1, 2, 0, 3, 1}, materials, counters),
            (std::vector<std::uint32_t>{2, 5, 6, 3, 0, 4}));
  EXPECT_TRUE(sorted({}, materials, counters).empty());
}

TEST(MaterialSort, HasAsManyDigitsAsTheLargestMaterial) {
  EXPECT_EQ(Materials({}).digits, 1);
  EXPECT_EQ(Materials({0}).digits, 1);
  EXPECT_EQ(Materials({3, 255}).digits, 1);
  EXPECT_EQ(Materials({256, 3}).digits, 2);
  EXPECT_EQ(Materials({65536}).digits, 3);
  EXPECT_EQ(Materials({0xfffffffe}).digits, 4);
}

TEST(MaterialSort, IsAStableSort) {
  std::mt19937 bits(5);
  for (const std::uint32_t most : {1u, 200u, 3000u, 1u << 20, 0xfffffffeu}) {
    std::vector<std::uint32_t> ids(500), triangles(2000), expected;
    for (std::uint32_t& id : ids) id = static_cast<std::uint32_t>(bits() % most);
    for (std::uint32_t& triangle : triangles)
      triangle = bits() % 4 == 0 ? kNoTriangle : static_cast<std::uint32_t>(bits() % 500);
    for (std::uint32_t i = 0; i < triangles.size(); ++i)
      if (triangles[i] != kNoTriangle) expected.push_back(i);
    std::stable_sort(expected.begin(), expected.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return ids[triangles[a]] < ids[triangles[b]]; });
    StageCounters counters;
    EXPECT_EQ(sorted(triangles, Materials(ids), counters), expected) << most;
  }
}

// Five samples, three of which show a triangle. Each is compared with "no triangle"; three materials are fetched. In
// each pass an item's digit is shifted and masked, and the digit's count fetched and raised, once to count and once to
// place. Then two sums for each of 256 digits.
TEST(MaterialSort, CountsItsWork) {
  const std::vector<std::uint32_t> triangles = {0, kNoTriangle, 1, kNoTriangle, 0};
  StageCounters one, two;
  sorted(triangles, Materials({7, 9}), one);
  sorted(triangles, Materials({7, 900}), two);
  const OperationCounts item{.add = 2, .bit = 4, .fetch = 2};
  OperationCounts once{.add = 5, .fetch = 3};
  once += OperationCounts{.add = 2} * 256;
  once += item * 3;
  OperationCounts twice{.add = 5, .fetch = 3};
  twice += OperationCounts{.add = 2} * 512;
  twice += item * 6;
  EXPECT_EQ(one.ops, once);
  EXPECT_EQ(two.ops, twice);
  EXPECT_EQ(one.items_in, 5u);
  EXPECT_EQ(one.items_out, 3u);
  EXPECT_EQ(one.lanes_used, 3u);
  EXPECT_EQ(one.lanes_issued, 5u);
  // Ids and materials of 4 bytes, 256 counts of 4 bytes a pass, items of 8 bytes. The first pass makes its items.
  EXPECT_EQ(one.bytes_read, 5u * 4 + 3 * 4 + 1024);
  EXPECT_EQ(one.bytes_written, 3u * 8 + 1024);
  EXPECT_EQ(two.bytes_read, 5u * 4 + 3 * 4 + 2 * 1024 + 3 * 8);
  EXPECT_EQ(two.bytes_written, 2 * (3u * 8 + 1024));
}

}  // namespace beampipe::material_sort_test
