// What a stage did in one frame, in items, operations, bytes and lanes; and the one table of these counters.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>

#include "stages/cost/stage.h"

namespace beampipe {

// Scalar operations by kind, as the stage's scalar formulas perform them. The table in counters.cpp says what each
// kind contains.
struct OperationCounts {
  std::uint64_t mul_add = 0;
  std::uint64_t add = 0;
  std::uint64_t bit = 0;
  std::uint64_t fetch = 0;
  std::uint64_t special = 0;
  std::uint64_t convert = 0;
  std::uint64_t wide = 0;  // the part of the others that has integers of 64 bits; not in the total

  std::uint64_t total() const { return mul_add + add + bit + fetch + special + convert; }

  OperationCounts& operator+=(const OperationCounts& other) {
    mul_add += other.mul_add;
    add += other.add;
    bit += other.bit;
    fetch += other.fetch;
    special += other.special;
    convert += other.convert;
    wide += other.wide;
    return *this;
  }
  friend OperationCounts operator+(OperationCounts one, const OperationCounts& other) { return one += other; }
  friend OperationCounts operator*(OperationCounts counts, std::uint64_t times) {
    counts.mul_add *= times;
    counts.add *= times;
    counts.bit *= times;
    counts.fetch *= times;
    counts.special *= times;
    counts.convert *= times;
    counts.wide *= times;
    return counts;
  }
  // By kind. Twins may use 64 bits for numbers that the stage knows to be small.
  bool operator==(const OperationCounts& other) const {
    return mul_add == other.mul_add && add == other.add && bit == other.bit && fetch == other.fetch &&
           special == other.special && convert == other.convert;
  }
};

// The table in counters.cpp says what each counter is.
struct StageCounters {
  Stage stage;  // none: nobody adds these counters up
  std::uint64_t items_in = 0;
  std::uint64_t items_out = 0;
  OperationCounts ops{};
  std::uint64_t bytes_read = 0;
  std::uint64_t bytes_written = 0;
  std::uint64_t position_tests = 0;
  std::uint64_t lanes_used = 0;
  std::uint64_t lanes_issued = 0;
  std::uint64_t sector_bytes = 0;
  std::uint64_t l2_bytes = 0;
  std::uint64_t dram_bytes = 0;
  std::uint64_t texture_bytes = 0;
  std::uint64_t texture_sector_bytes = 0;
  std::uint64_t texture_l2_bytes = 0;
  std::uint64_t texture_dram_bytes = 0;
  std::uint64_t hidden_items = 0;
  std::uint64_t hidden_triangles = 0;
  std::uint64_t empty_tiles = 0;

  std::uint64_t logical_bytes() const { return bytes_read + bytes_written; }

  // Leaves `stage` as it is. Throws std::logic_error if `other` counts another stage; its pass may be another one.
  // Counters that have no stage add up any.
  StageCounters& operator+=(const StageCounters& other);
  bool operator==(const StageCounters&) const = default;
};

// The counters of that stage; null if `all` has none.
template <class AllCounters>
auto* find_counters(AllCounters& all, Stage stage) {
  const auto found = std::find_if(all.begin(), all.end(), [&](const auto& each) { return each.stage == stage; });
  return found == all.end() ? nullptr : &*found;
}

// A counter of a stage. It is stored in StageCounters (`field`), in its operations (`operation`), or it is computed
// from others (`sum`); exactly one of the three is not null.
struct CounterInfo {
  const char* name;   // as in report.json; "ops.add" is the key "add" of the object "ops"
  const char* title;  // heading of a table's column
  const char* unit;
  const char* meaning;
  CounterGroups group;  // a stage has the counter if it has one of these groups
  std::uint64_t StageCounters::*field = nullptr;
  std::uint64_t OperationCounts::*operation = nullptr;
  std::uint64_t (*sum)(const StageCounters&) = nullptr;

  std::uint64_t value(const StageCounters& counters) const {
    return sum ? sum(counters) : field ? counters.*field : counters.ops.*operation;
  }
  // Where the counter is stored; null for a sum. Saving and restoring every stored counter restores the stage.
  std::uint64_t* stored(StageCounters& counters) const {
    return sum ? nullptr : field ? &(counters.*field) : &(counters.ops.*operation);
  }
};

// All counters of a stage, in the order in which report.json lists them.
std::span<const CounterInfo> stage_counters();

// Does the counter count anything in this stage?
inline bool has_counter(const StageInfo& stage, const CounterInfo& counter) {
  return (stage.counts & counter.group) != 0;
}

}  // namespace beampipe
