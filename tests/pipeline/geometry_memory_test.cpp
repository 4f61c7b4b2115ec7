// How bins read setup triangles and attributes: in order, and by triangle number.
#include "pipeline/memory/geometry_memory.h"

#include "tests/test.h"

namespace beampipe::geometry_memory_test {

std::set<std::uint64_t> sectors_of_record(std::uint64_t record, std::uint64_t bytes) {
  std::set<std::uint64_t> sectors;
  for (std::uint64_t at = record * bytes; at < (record + 1) * bytes; ++at) sectors.insert(at / 32);
  return sectors;
}

TriangleList random_list(std::uint32_t seed) {
  std::mt19937 random(seed);
  TriangleList list;
  for (std::uint32_t triangle = random() % 5; list.size() < 200;
       triangle += 1 + (random() % 4 == 0 ? random() % 50 : 0))
    list.push_back(triangle);
  return list;
}

TEST(GeometryMemory, ABinReadsItsListAndTheSectorsOfItsTriangles) {
  for (std::uint32_t seed = 0; seed < 20; ++seed) {
    const TriangleList list = random_list(seed);
    std::set<std::uint64_t> sectors;
    for (const std::uint32_t triangle : list) sectors.merge(sectors_of_record(triangle, 88));
    StageCounters counters;
    read_bin({}, list, counters);
    EXPECT_EQ(counters.dram_bytes, 4 * list.size() + 32 * sectors.size()) << "seed " << seed;
    EXPECT_EQ(counters.sector_bytes, counters.dram_bytes);
  }
}

TEST(GeometryMemory, AttributesInOrderAreReadOncePerTriangle) {
  struct Fragment {
    std::uint32_t triangle;
  };
  StageCounters counters;
  AttributesInOrder attributes{MemoryParameters{}};
  attributes.read(std::vector<Fragment>{{0}, {0}, {0}, {2}}, counters);  // bytes 0 to 27 and 56 to 83: sectors 0 to 2
  EXPECT_EQ(counters.dram_bytes, 96u);
  attributes.read(std::vector<Fragment>{{2}, {3}}, counters);  // up to byte 111
  EXPECT_EQ(counters.dram_bytes, 128u);
  EXPECT_EQ(counters.sector_bytes, 128u);
}

TEST(GeometryMemory, FetchesAskForEachRecordAndFetchEachSectorOnce) {
  for (std::uint32_t seed = 0; seed < 20; ++seed) {
    const TriangleList list = random_list(seed);
    std::mt19937 random(seed);
    std::set<std::uint64_t> setups, attributes;
    std::uint64_t asked = 0;
    StageCounters counters;
    TriangleFetches fetches({}, list);
    for (int i = 0; i < 500; ++i) {
      const std::uint32_t triangle = list[random() % list.size()];
      if (random() % 2) {
        fetches.setup(triangle, counters);
        asked += sectors_of_record(triangle, 88).size();
        setups.merge(sectors_of_record(triangle, 88));
      } else {
        fetches.attributes(triangle, counters);
        asked += sectors_of_record(triangle, 28).size();
        attributes.merge(sectors_of_record(triangle, 28));
      }
    }
    fetches.flush(counters);
    EXPECT_EQ(counters.sector_bytes, 32 * asked) << "seed " << seed;
    EXPECT_EQ(counters.l2_bytes, 32 * (setups.size() + attributes.size()))
        << "200 triangles fit into L1; seed " << seed;
    EXPECT_EQ(counters.dram_bytes, counters.l2_bytes) << "seed " << seed;
  }
}

TEST(GeometryMemory, WhatL1CannotHoldIsAskedOfL2AgainAndNotOfDram) {
  TriangleList list;
  for (std::uint32_t triangle = 0; triangle < 1000; ++triangle) list.push_back(triangle);  // 88 KB; L1 has 32 KiB
  StageCounters counters;
  TriangleFetches fetches({}, list);
  for (int round = 0; round < 2; ++round)
    for (const std::uint32_t triangle : list) fetches.setup(triangle, counters);
  fetches.flush(counters);
  EXPECT_EQ(counters.dram_bytes, 88'000u);
  EXPECT_EQ(counters.l2_bytes, 2 * 88'000u);
}

TEST(GeometryMemory, WhatTheRasterHasReadIsInL2) {
  const TriangleList list = {0, 1, 7};
  StageCounters counters;
  TriangleFetches fetches({}, list);
  fetches.load_setup();
  fetches.depth(7, counters);  // bytes 656 to 695: sectors 20 and 21
  fetches.depth(7, counters);
  fetches.flush(counters);
  EXPECT_EQ(counters.sector_bytes, 2 * 64u);
  EXPECT_EQ(counters.l2_bytes, 64u);
  EXPECT_EQ(counters.dram_bytes, 0u);
}

// A list of 5.6 MB in L2, which has 4.5 MiB. An order that returns to a line only after all others finds nothing there,
// so every record fetches the sectors that it shares with others once more.
TEST(GeometryMemory, SortedSetupOfALongListIsFetchedAgain) {
  TriangleList list, strided;
  for (std::uint32_t triangle = 0; triangle < 64'000; ++triangle) list.push_back(triangle);
  for (std::uint32_t first = 0; first < 2; ++first)
    for (std::uint32_t triangle = first; triangle < 64'000; triangle += 2) strided.push_back(triangle);
  StageCounters in_order, sorted;
  TriangleFetches({}, list).read_setup(list, in_order);
  EXPECT_EQ(in_order.dram_bytes, 64'000u * 88);
  TriangleFetches({}, list).read_setup(strided, sorted);
  std::uint64_t sectors = 0;
  for (const std::uint32_t triangle : strided) sectors += sectors_of_record(triangle, 88).size();
  EXPECT_EQ(sorted.sector_bytes, 32 * sectors);
  EXPECT_EQ(sorted.dram_bytes, 32 * sectors);
}

TEST(GeometryMemory, WhereNothingIsModelledNothingIsCounted) {
  MemoryParameters off;
  off.modelled = false;
  StageCounters counters;
  move_setup(off, 48, 4, 0, counters);
  write_list(off, {0, 1}, counters);
  read_bin(off, {0, 1}, counters);
  const TriangleList list = {0, 1};
  TriangleFetches fetches(off, list);
  fetches.setup(1, counters);
  fetches.read_setup(list, counters);
  fetches.flush(counters);
  EXPECT_EQ(counters, StageCounters{});
}

}  // namespace beampipe::geometry_memory_test
