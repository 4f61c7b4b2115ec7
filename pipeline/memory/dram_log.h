// DRAM requests of one bin, as they are made: which stage reads or writes which sectors of which array.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "pipeline/memory/dram_tally.h"
#include "pipeline/memory/parameters.h"
#include "stages/cost/counters.h"

namespace beampipe {

inline constexpr std::uint32_t kMaxBlockSectors = 8;

// Sectors [first, first + sectors) of an array, one after the other.
struct DramRun {
  std::uint64_t first = 0;  // of an array of bins: from the start of the bin's part
  std::uint32_t sectors = 0;
  std::uint16_t array = 0;
  std::uint8_t stage = 0;  // Stage::number()
  DramAccess access = DramAccess::read;
};

// An array of the modelled memory. It belongs to the frame, or each bin has a part of its own.
struct DramArray {
  std::string name;
  bool of_bins = false;
  std::uint64_t sectors = 0;  // that are in use: of the frame, or of the bin's part
};

class DramLog {
 public:
  // The number of the array of that name.
  std::uint16_t array(std::string_view name, bool of_bins);

  // The array has at least so many sectors, which may never move.
  void reserve(std::uint16_t array, std::uint64_t sectors);

  // `stage`: that asks. Requests of StageId::none are left out, because nobody adds its counters up.
  void add(std::uint16_t array, DramAccess access, std::uint64_t first, std::uint32_t sectors, Stage stage);

  // Passes over the frame, counted from 0: what a bin does in a pass comes after everything that any bin does in an
  // earlier pass.
  std::uint32_t pass() const { return static_cast<std::uint32_t>(passes_.size() - 1); }
  void start_pass() {
    if (!passes_.back().empty()) passes_.emplace_back();
  }
  // At least this pass.
  void reach_pass(std::uint32_t pass) {
    if (passes_.size() <= pass) passes_.resize(pass + 1);
  }

  const std::vector<std::vector<DramRun>>& passes() const { return passes_; }
  const std::vector<DramArray>& arrays() const { return arrays_; }

 private:
  std::vector<std::vector<DramRun>> passes_ = {{}};
  std::vector<DramArray> arrays_;
};

// The memory system as a bin uses it: the parameters, and where it records its DRAM requests, their sums by array, and
// the reach of caches.
struct MemorySystem : MemoryParameters {
  DramLog* log = nullptr;       // null: nowhere
  DramTally* tally = nullptr;   // likewise
  CacheReach* reach = nullptr;  // likewise

  MemorySystem(const MemoryParameters& parameters = {}, DramLog* requests = nullptr, DramTally* sums = nullptr)
      : MemoryParameters(parameters), log(requests), tally(sums) {}
};

// Where the blocks of a cache lie: block b at line b of `array` or, if `lines` are given, at lines[b]. A cache may
// stand before several arrays, which follow each other.
struct BlockPlaces {
  struct Line {
    std::uint16_t array;
    std::uint64_t number;
  };

  DramLog* log = nullptr;  // null: nothing is recorded
  std::uint16_t array = 0;
  std::vector<Line> lines = {};

  struct Part {
    std::size_t first_block;
    std::uint16_t array;
  };
  DramTally* tally = nullptr;    // null: nothing is added up
  std::vector<Part> parts = {};  // of the cache, by array of the tally

  BlockPlaces() = default;
  BlockPlaces(const MemorySystem& memory, std::string_view name, bool of_bins) : log(memory.log), tally(memory.tally) {
    if (log) array = log->array(name, of_bins);
    if (tally) parts.push_back({0, tally->array(name)});
  }

  // Of the tally.
  std::uint16_t array_of(std::size_t block) const {
    std::size_t part = parts.size() - 1;
    while (parts[part].first_block > block) --part;
    return parts[part].array;
  }
};

}  // namespace beampipe
