// How bins read setup triangles and attributes: in order, and by triangle number.
#include "pipeline/memory/geometry_memory.h"

#include <gtest/gtest.h>

#include <random>
#include <set>

namespace beampipe {
namespace {

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

TEST(GeometryMemory, SetupIsWrittenOnce) {
  StageCounters counters;
  move_setup({}, 48, 4, counters);
  EXPECT_EQ(counters.dram_bytes, 64u + 4 * 88 + 128);
  EXPECT_EQ(counters.sector_bytes, counters.dram_bytes);
  EXPECT_EQ(counters.l2_bytes, counters.dram_bytes);
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

TEST(GeometryMemory, WhereNothingIsModelledNothingIsCounted) {
  MemoryParameters off;
  off.modelled = false;
  StageCounters counters;
  move_setup(off, 48, 4, counters);
  write_list(off, {0, 1}, counters);
  read_bin(off, {0, 1}, counters);
  const TriangleList list = {0, 1};
  TriangleFetches fetches(off, list);
  fetches.setup(1, counters);
  fetches.flush(counters);
  EXPECT_EQ(counters, StageCounters{});
}

}  // namespace
}  // namespace beampipe
