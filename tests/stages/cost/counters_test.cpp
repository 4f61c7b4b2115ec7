// The table of a stage's counters: adding up, saving and restoring depend on it.
#include "stages/cost/counters.h"

#include "tests/test.h"

namespace beampipe::counters_test {

// The k-th stored counter is k times `unit`.
StageCounters numbered(std::uint64_t unit) {
  StageCounters counters{StageId::compose};
  std::uint64_t value = 0;
  for (const CounterInfo& counter : stage_counters())
    if (std::uint64_t* const stored = counter.stored(counters)) *stored = value += unit;
  return counters;
}

TEST(StageCountersTable, NamesEachCounterOnce) {
  StageCounters counters;
  std::set<std::string> names;
  std::set<const std::uint64_t*> places;
  std::size_t stored = 0;
  for (const CounterInfo& counter : stage_counters()) {
    EXPECT_TRUE(names.insert(counter.name).second) << counter.name;
    const std::uint64_t* const place = counter.stored(counters);
    if (!place) continue;
    ++stored;
    EXPECT_TRUE(places.insert(place).second) << counter.name << " is stored where another counter is";
  }
  EXPECT_EQ(stored, sizeof(StageCounters) / sizeof(std::uint64_t) - 1);
}

TEST(StageCountersTable, ValuesAreThoseOfTheFields) {
  const StageCounters counters = numbered(1);
  EXPECT_EQ(counters.items_in, 1u);
  EXPECT_EQ(counters.items_out, 2u);
  EXPECT_EQ(counters.ops, (OperationCounts{.mul_add = 3, .add = 4, .bit = 5, .fetch = 6, .special = 7, .convert = 8}));
  EXPECT_EQ(counters.ops.wide, 9u);
  EXPECT_EQ(counters.bytes_read, 10u);
  EXPECT_EQ(counters.bytes_written, 11u);
  EXPECT_EQ(counters.sector_bytes, 12u);
  EXPECT_EQ(counters.l2_bytes, 13u);
  EXPECT_EQ(counters.dram_bytes, 14u);
  EXPECT_EQ(counters.texture_bytes, 15u);
  EXPECT_EQ(counters.texture_sector_bytes, 16u);
  EXPECT_EQ(counters.texture_l2_bytes, 17u);
  EXPECT_EQ(counters.texture_dram_bytes, 18u);
  EXPECT_EQ(counters.position_tests, 19u);
  EXPECT_EQ(counters.lanes_used, 20u);
  EXPECT_EQ(counters.lanes_issued, 21u);
  EXPECT_EQ(counters.hidden_items, 22u);
  EXPECT_EQ(counters.hidden_triangles, 23u);
  EXPECT_EQ(counters.empty_tiles, 24u);
  std::uint64_t value = 0;
  for (const CounterInfo& counter : stage_counters()) {
    const std::string name = counter.name;
    const std::uint64_t expected = name == "ops.total" ? 3 + 4 + 5 + 6 + 7 + 8 : name == "logical_bytes" ? 21 : ++value;
    EXPECT_EQ(counter.value(counters), expected) << name;
  }
}

TEST(StageCountersTable, AdditionAddsEachCounterAndKeepsThePass) {
  StageCounters sum = numbered(1);
  StageCounters other = numbered(100);
  other.stage.pass = Pass::prepass;
  sum += other;
  EXPECT_EQ(sum, numbered(101));
}

TEST(StageCountersTable, CountersOfAStageTakeNoOthers) {
  StageCounters sum = numbered(1), other = numbered(100), of_all;
  for (const StageId id : {StageId::shade, StageId::none}) {
    other.stage = id;
    EXPECT_THROW(sum += other, std::logic_error);
  }
  EXPECT_EQ(sum, numbered(1)) << "nothing is added";
  of_all += sum, of_all += other;
  EXPECT_EQ(of_all.items_in, 101u);
}

TEST(StageCountersTable, CountersAreFoundByStageAndPass) {
  const Stage prepass(StageId::compose, Pass::prepass);
  std::vector<StageCounters> all = {StageCounters{prepass}, StageCounters{StageId::compose}};
  EXPECT_EQ(find_counters(all, prepass), &all[0]);
  EXPECT_EQ(find_counters(all, StageId::compose), &all[1]);
  EXPECT_EQ(find_counters(all, StageId::shade), nullptr);
}

}  // namespace beampipe::counters_test
