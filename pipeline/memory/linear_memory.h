// Memory other than surfaces: streams that no cache can help, records read in order, and records that shaders read and
// write anywhere.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string_view>
#include <vector>

#include "pipeline/memory/block_cache.h"
#include "pipeline/memory/parameters.h"
#include "stages/cost/counters.h"

namespace beampipe {

// An array of the frame, or of which each bin has a part.
struct ArrayName {
  std::string_view name;
  bool of_bins = true;

  // In the memory system's tally.
  std::uint16_t number(const MemorySystem& memory) const { return memory.tally ? memory.tally->array(name) : 0; }
};

struct ArrayPart {
  ArrayName array;
  std::uint16_t number;     // array.number()
  std::uint64_t first = 0;  // sector
};

// Moves `bytes` in a row, in whole sectors, between a stage and L2, which has them from elsewhere.
inline void stream_in_l2(const MemorySystem& memory, std::uint16_t array, std::uint64_t bytes,
                         StageCounters& counters) {
  if (!memory.modelled) return;
  const std::uint64_t whole = memory.sectors(bytes) * memory.sector_bytes;
  counters.sector_bytes += whole;
  counters.l2_bytes += whole;
  if (memory.tally) memory.tally->add_l2(array, counters.stage, whole);
}

// Moves them between L2 and DRAM.
inline void stream_in_dram(const MemorySystem& memory, DramAccess access, const ArrayPart& part, std::uint64_t bytes,
                           StageCounters& counters) {
  if (!memory.modelled) return;
  const std::uint64_t sectors = memory.sectors(bytes);
  counters.dram_bytes += sectors * memory.sector_bytes;
  if (memory.tally) memory.tally->add(part.number, access, counters.stage, sectors * memory.sector_bytes);
  if (memory.log)
    memory.log->add(memory.log->array(part.array.name, part.array.of_bins), access, part.first,
                    static_cast<std::uint32_t>(sectors), counters.stage);
}

// Reads or writes `bytes` in a row: whole sectors, each moved once.
inline void stream_part(const MemorySystem& memory, DramAccess access, const ArrayPart& part, std::uint64_t bytes,
                        StageCounters& counters) {
  stream_in_l2(memory, part.number, bytes, counters);
  stream_in_dram(memory, access, part, bytes, counters);
}

inline void stream(const MemorySystem& memory, DramAccess access, const ArrayName& array, std::uint64_t bytes,
                   StageCounters& counters) {
  stream_part(memory, access, {array, array.number(memory)}, bytes, counters);
}

// Some records of an array of the frame, read in increasing order. A sector that the previous record shares is not read
// again.
class RecordsInOrder {
 public:
  RecordsInOrder(const MemorySystem& memory, std::string_view array, std::uint32_t record_bytes)
      : memory_(memory), array_{array, false}, number_(array_.number(memory)), record_bytes_(record_bytes) {}

  void read(std::uint32_t record, StageCounters& counters) {
    const std::uint64_t begin = std::uint64_t{record} * record_bytes_, end = begin + record_bytes_;
    const std::uint64_t first = std::max(begin >> std::countr_zero(memory_.sector_bytes), read_to_);
    const std::uint64_t end_sector = memory_.sectors(end);
    if (end_sector <= first) return;
    stream_part(memory_, DramAccess::read, {array_, number_, first}, (end_sector - first) * memory_.sector_bytes,
                counters);
    read_to_ = end_sector;
  }

 private:
  MemorySystem memory_;
  ArrayName array_;
  std::uint16_t number_;
  std::uint64_t record_bytes_, read_to_ = 0;  // all sectors below it have been read or skipped
};

// Memory as shaders access it: writes go to L2, reads go through an L1. Accesses are bytes [begin, begin + bytes).
class LinearMemory {
 public:
  // `places`: as for BlockCache.
  LinearMemory(const MemorySystem& memory, std::size_t size, BlockPlaces places = {});

  void write(std::uint32_t key, std::size_t begin, std::uint32_t bytes, StageCounters& counters);
  void read(std::uint32_t key, std::size_t begin, std::uint32_t bytes, StageCounters& counters);

  // Reads that are a request each: `times` for the same bytes, one after the other.
  void fetch(std::size_t begin, std::uint32_t bytes, std::uint64_t times, StageCounters& counters);

  // A stage that has no L1 reads records one after the other, so L2 holds them then. A line is asked for once while
  // records that lie in it follow each other.
  void read_through_l2(const std::vector<std::uint32_t>& begins, std::uint32_t bytes, StageCounters& counters);

  // The end of a pass over the frame.
  void flush(StageCounters& counters);

 private:
  template <class Access>
  void each_line(std::size_t begin, std::uint32_t bytes, Access&& access) const;

  std::uint32_t line_bytes_;
  int log2_line_;
  BlockCache l2_, l1_;
};

}  // namespace beampipe
