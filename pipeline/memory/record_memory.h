// The pool of a bin's records in memory, where pixels are not on chip.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "pipeline/memory/block_cache.h"
#include "stages/data/pooled_pixels.h"

namespace beampipe {

// Chunks of the pool with their links, one after the other. A record takes the chunks that were given back last, and
// where there are none, those that were never taken.
class RecordMemory {
 public:
  struct Chunks {
    std::uint32_t most;   // of a record
    std::uint32_t bytes;  // of each, with its link
  };

  // `name`: of the array that all bins' pools are parts of. `memory` must outlive this.
  RecordMemory(const MemorySystem& memory, std::string_view name, std::size_t pixels, const Chunks& chunks);

  // The record's chunks become as many as the visit says, and all of them are read or written.
  void access(const RecordVisit& visit, StageCounters& counters);

  // The end of a pass: everything goes back to memory.
  void flush(StageCounters& counters);

  // Adds the logical bytes that were read and written, to the pixels whose records they are.
  void add_bytes(std::vector<float>& pixels) const;

 private:
  void resize(std::vector<std::uint32_t>& record, const RecordVisit& visit, StageCounters& counters);
  void access_chunk(std::uint32_t key, std::uint32_t chunk, bool is_write, StageCounters& counters);

  const MemorySystem& memory_;
  std::uint32_t chunk_bytes_, per_block_;  // chunks in a line of the cache
  std::uint32_t never_taken_ = 0;
  std::vector<std::uint32_t> free_;
  std::vector<std::vector<std::uint32_t>> records_;  // by pixel: its chunks
  std::vector<std::uint32_t> touched_;               // by pixel: chunks that were read or written
  BlockCache cache_;
};

}  // namespace beampipe
