#include "stages/data/pooled_pixels.h"

#include <gtest/gtest.h>

namespace beampipe::pooled_pixels_test {

TEST(RecordShape, HasAsManyPlanesAsItsStatesNeed) {
  const std::pair<std::size_t, std::uint32_t> cases[] = {{0, 0}, {1, 0}, {2, 1},  {3, 2},
                                                         {4, 2}, {5, 3}, {17, 5}, {32, 5}};
  for (const auto& [states, planes] : cases) EXPECT_EQ(planes_for(states), planes) << states;
}

// A chunk has 16 bytes. A plane has two of them with 256 positions, and half a one with 64; a surface has half a one,
// and the sums have one.
TEST(RecordShape, ChunksByHand) {
  const struct {
    RecordShape shape;
    std::uint32_t of_256, of_64;
  } cases[] = {
      {{.owners = 2}, 2 + 1, 1 + 1},                     // an edge
      {{.owners = 1, .has_empty = true}, 2 + 1, 1 + 1},  // in front of nothing
      {{.owners = 1, .has_sums = true}, 1 + 1, 1 + 1},   // with a speck on it
      {{.owners = 3, .has_empty = true}, 4 + 2, 1 + 2},  // four states, two planes
      {{.owners = 5, .has_empty = true}, 6 + 3, 2 + 3},  // six states, three planes
      {{.owners = 2, .has_empty = true, .has_final = true, .has_sums = true}, 4 + 1 + 1, 1 + 1 + 1},
      {{.owners = 30, .has_empty = true, .has_final = true, .has_sums = true}, 10 + 15 + 1, 3 + 15 + 1},
  };
  for (const auto& [shape, of_256, of_64] : cases) {
    EXPECT_EQ(shape.chunks(8), of_256) << int{shape.owners};
    EXPECT_EQ(shape.chunks(2), of_64) << int{shape.owners};
  }
  EXPECT_EQ(most_chunks(8), 26u);
  EXPECT_EQ(least_chunks(4), 2u);
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

// Two chunks are guaranteed to each record.
TEST(ChunkPool, AFramesPoolHasRoomUntilItIsClosed) {
  ChunkPool pool = ChunkPool::of_frame(2);
  ChunkPool::Chunks one, other;
  EXPECT_TRUE(pool.has_room(one, 26));
  pool.resize(one, 5), pool.resize(other, 1);
  EXPECT_EQ(pool.beyond_guaranteed(), 3u);
  pool.close();
  EXPECT_TRUE(pool.has_room(one, 5));
  EXPECT_FALSE(pool.has_room(one, 6));
  EXPECT_TRUE(pool.has_room(other, 2));
  EXPECT_FALSE(pool.has_room(other, 3));
  pool.resize(one, 1);
  EXPECT_EQ(pool.beyond_guaranteed(), 0u);
  EXPECT_TRUE(pool.has_room(one, 2));
  EXPECT_FALSE(pool.has_room(one, 3)) << "what was given back is not taken again";
}

// Records of all sizes keep their contents while others come and go.
TEST(RecordStore, RecordsStayWhereTheyAre) {
  RecordStore<8> store;
  std::vector<std::pair<std::uint8_t, void*>> records;
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
