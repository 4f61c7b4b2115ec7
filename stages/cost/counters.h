// What a stage did in one frame, in items, operations, bytes and lanes; and the one table of these counters.
#pragma once

#include <cstdint>
#include <span>

#include "stages/cost/stage.h"

namespace beampipe {

#ifdef BEAMPIPE_COUNT_NOTHING
// Drops whatever is added to it. A program built this way has no counters, which shows what counting costs.
struct Count {
  constexpr Count(std::uint64_t = 0) {}
  constexpr operator std::uint64_t() const { return 0; }
  constexpr Count& operator+=(std::uint64_t) { return *this; }
  constexpr Count& operator-=(std::uint64_t) { return *this; }
  constexpr Count& operator*=(std::uint64_t) { return *this; }
  constexpr Count& operator++() { return *this; }
};
#else
using Count = std::uint64_t;
#endif

// Scalar operations by kind, as the stage's scalar formulas perform them. The table in counters.cpp says what each
// kind contains.
struct OperationCounts {
  Count mul_add = 0;
  Count add = 0;
  Count bit = 0;
  Count fetch = 0;
  Count special = 0;
  Count convert = 0;
  Count wide = 0;  // the part of the others that has integers of 64 bits; not in the total

  Count total() const { return mul_add + add + bit + fetch + special + convert; }

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
  Count items_in = 0;
  Count items_out = 0;
  OperationCounts ops{};
  Count bytes_read = 0;
  Count bytes_written = 0;
  Count position_tests = 0;
  Count lanes_used = 0;
  Count lanes_issued = 0;
  Count sector_bytes = 0;
  Count l2_bytes = 0;
  Count dram_bytes = 0;
  Count texture_bytes = 0;
  Count texture_sector_bytes = 0;
  Count texture_l2_bytes = 0;
  Count texture_dram_bytes = 0;
  Count hidden_items = 0;
  Count hidden_triangles = 0;
  Count empty_tiles = 0;

  Count logical_bytes() const { return bytes_read + bytes_written; }

  StageCounters& operator+=(const StageCounters& other);  // leaves `stage` as it is
  bool operator==(const StageCounters&) const = default;
};

// A counter of a stage. It is stored in StageCounters (`field`), in its operations (`operation`), or it is computed
// from others (`sum`); exactly one of the three is not null.
struct CounterInfo {
  const char* name;   // as in report.json; "ops.add" is the key "add" of the object "ops"
  const char* title;  // heading of a table's column
  const char* unit;
  const char* meaning;
  CounterGroups group;  // a stage has the counter if it has one of these groups
  Count StageCounters::*field = nullptr;
  Count OperationCounts::*operation = nullptr;
  Count (*sum)(const StageCounters&) = nullptr;

  Count value(const StageCounters& counters) const {
    return sum ? sum(counters) : field ? counters.*field : counters.ops.*operation;
  }
  // Where the counter is stored; null for a sum. Saving and restoring every stored counter restores the stage.
  Count* stored(StageCounters& counters) const {
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
