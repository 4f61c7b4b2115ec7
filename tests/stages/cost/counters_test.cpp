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
  EXPECT_EQ(counters.ops, (OperationCounts{.mul_add = 3, .add = 4, .bit = 5, .fetch = 6, .special = 7, .convert = 8}));
  const StageCounters& c = counters;
  const std::uint64_t after_ops[] = {
      c.ops.wide,      c.bytes_read,           c.bytes_written,    c.sector_bytes,       c.l2_bytes,       c.dram_bytes,
      c.texture_bytes, c.texture_sector_bytes, c.texture_l2_bytes, c.texture_dram_bytes, c.position_tests, c.lanes_used,
      c.lanes_issued,  c.hidden_items,         c.hidden_triangles, c.empty_tiles};
  EXPECT_EQ((std::pair{c.items_in, c.items_out}), (std::pair{std::uint64_t{1}, std::uint64_t{2}}));
  for (std::size_t i = 0; i < std::size(after_ops); ++i) EXPECT_EQ(after_ops[i], 9 + i);
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
