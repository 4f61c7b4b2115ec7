#include "stages/data/pooled_pixels.h"

#include <gtest/gtest.h>

namespace beampipe::pooled_pixels_test {

TEST(RecordShape, HasAsManyPlanesAsItsStatesNeed) {
  const std::pair<std::size_t, std::uint32_t> cases[] = {{0, 0}, {1, 0}, {2, 1},  {3, 2},
                                                         {4, 2}, {5, 3}, {17, 5}, {32, 5}};
  for (const auto& [states, planes] : cases) EXPECT_EQ(planes_for(states), planes) << states;
}

// With 256 positions a plane has 32 bytes, a surface 8, and sums 16. A chunk has 16 bytes.
TEST(RecordShape, BytesByHand) {
  const struct {
    RecordShape shape;
    std::uint32_t bytes, chunks;
  } cases[] = {
      {{.owners = 2}, 32 + 16, 3},                     // an edge
      {{.owners = 1, .has_empty = true}, 32 + 8, 3},   // in front of nothing
      {{.owners = 1, .has_sums = true}, 8 + 16, 2},    // with a speck on it
      {{.owners = 3, .has_empty = true}, 64 + 24, 6},  // four states
      {{.owners = 2, .has_empty = true, .has_final = true, .has_sums = true}, 64 + 16 + 16, 6},
      {{.owners = 30, .has_empty = true, .has_final = true, .has_sums = true}, 160 + 240 + 16, 26},
  };
  for (const auto& [shape, bytes, chunks] : cases) {
    EXPECT_EQ(shape.bytes(8), bytes) << int{shape.owners};
    EXPECT_EQ(shape.chunks(8), chunks) << int{shape.owners};
  }
  EXPECT_EQ((RecordShape{.owners = 2}.bytes(1)), 4u + 16);
}

// A chunk takes 18 bytes with its link.
TEST(ChunkPool, WhatDoesNotFitIsInMemory) {
  ChunkPool pool(10 * 18 + 17);
  ChunkPool::Chunks one, other;
  pool.resize(one, 6);
  EXPECT_EQ(one.in_memory, 0);
  pool.resize(other, 7);
  EXPECT_EQ(other.in_memory, 3);
  EXPECT_EQ(pool.used(), 13u);
  pool.resize(other, 5);  // chunks in memory go first
  EXPECT_EQ(other.in_memory, 1);
  pool.resize(one, 2);
  pool.resize(other, 8);  // four are free on chip, of which this takes three
  EXPECT_EQ(other.in_memory, 1);
  pool.resize(one, 4);
  EXPECT_EQ(one.in_memory, 1);
  pool.resize(one, 0), pool.resize(other, 0);
  EXPECT_EQ(pool.used(), 0u);
  EXPECT_EQ(pool.peak(), 13u);
  EXPECT_EQ(pool.peak_in_memory(), 3u);
}

TEST(ChunkPool, CollectionsArePaidByWhatWasTaken) {
  ChunkPool pool(16 * 18);
  ChunkPool::Chunks record;
  pool.resize(record, 14);
  EXPECT_FALSE(pool.wants_collection()) << "seven eighths are in use, and not more";
  pool.resize(record, 15);
  EXPECT_TRUE(pool.wants_collection());
  pool.collected();
  pool.resize(record, 19);
  EXPECT_FALSE(pool.wants_collection()) << "a quarter was taken, and not more";
  pool.resize(record, 20);
  EXPECT_TRUE(pool.wants_collection());
}

// Records of all sizes keep their contents while others come and go.
TEST(RecordStore, RecordsStayWhereTheyAre) {
  RecordStore<8> store;
  std::vector<std::pair<std::uint8_t, std::uint32_t>> records;
  const auto last_of = [&](std::size_t i) -> std::uint32_t& {
    const auto [size, record] = records[i];
    return store.view(size, record).owned(RecordStore<8>::owners_in(size) - 1)[7];
  };
  for (std::uint32_t i = 0; i < 999; ++i) {
    const auto size = static_cast<std::uint8_t>(i % 3);
    records.emplace_back(size, store.take(size));
    last_of(i) = i;
  }
  for (std::uint32_t i = 0; i < 999; i += 2) store.give_back(records[i].first, records[i].second);
  for (std::uint32_t i = 0; i < 999; i += 2) {
    records[i].second = store.take(records[i].first);
    last_of(i) = ~0u;
  }
  for (std::uint32_t i = 1; i < 999; i += 2) ASSERT_EQ(last_of(i), i);
  for (const auto& [owners, size] : {std::pair{1, 0}, {8, 0}, {9, 1}, {16, 1}, {17, 2}, {31, 2}})
    EXPECT_EQ(RecordStore<8>::size_for(static_cast<std::size_t>(owners)), size) << owners;
}

}  // namespace beampipe::pooled_pixels_test
