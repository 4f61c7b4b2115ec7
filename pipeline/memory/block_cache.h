// Blocks of memory behind a set-associative write-back cache: which bytes really move.
//
// A block has a state in memory: cleared (its content is known from the state), compressed to some sectors, or raw. A
// line of the cache holds one block, each of its sectors valid or not, dirty or not.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "pipeline/memory/parameters.h"
#include "stages/counters.h"

namespace beampipe {

inline constexpr std::uint32_t kMaxBlockSectors = 8;

class BlockCache {
 public:
  // Bytes that a block takes when compressed; its raw size or more: it does not compress.
  using CompressedBytes = std::function<std::uint32_t(std::size_t block)>;

  // `block_bytes` <= cache.line_bytes, at most kMaxBlockSectors. `cleared`: the state that all blocks start in; else
  // they are raw. An empty `compressed_bytes`: nothing compresses. Where memory is not modelled, nothing is done or
  // counted.
  BlockCache(const MemoryParameters& memory, const CacheParameters& cache, std::size_t blocks,
             std::uint32_t block_bytes, bool cleared, CompressedBytes compressed_bytes);

  // Reads or writes bytes [first, first + bytes) of a block. Accesses of a stage that follow each other with the same
  // block and key (the triangle, usually) are one request, each of whose sectors is asked for once to be read and once
  // to be written. Adds to counters.sector_bytes what is asked for, and to counters.dram_bytes what is fetched and
  // written back for it. A sector that is written in part is fetched first. No byte is written twice in one request.
  void read(std::uint32_t key, std::size_t block, std::uint32_t first, std::uint32_t bytes, StageCounters& counters) {
    if (!modelled_) return;
    begin_request(key, block, counters);
    request_.read |= sectors_of(first, bytes);
  }
  void write(std::uint32_t key, std::size_t block, std::uint32_t first, std::uint32_t bytes, StageCounters& counters) {
    if (!modelled_) return;
    begin_request(key, block, counters);
    request_.write |= sectors_of(first, bytes);
    const std::uint32_t end = first + bytes;
    for (std::uint32_t at = first; at < end;) {
      const std::uint32_t sector = at / kSectorBytes, stop = std::min(end, (sector + 1) * kSectorBytes);
      request_.written_bytes[sector] += stop - at;
      at = stop;
    }
  }

  // Writes back every dirty line and empties the cache.
  void flush(StageCounters& counters);

  // Reads a whole block past the cache, which is empty.
  void stream_read(std::size_t block, StageCounters& counters) const;

  std::size_t blocks() const { return states_.size(); }

 private:
  static constexpr std::uint32_t kSectorBytes = MemoryParameters::sector_bytes;
  using Sectors = std::uint8_t;  // a bit for each sector of a block

  // In memory: kRaw, or the sectors that the block is compressed to; 0: cleared.
  using State = std::uint8_t;
  static constexpr State kRaw = 255;
  static constexpr std::uint32_t kEmpty = ~0u;

  struct Line {
    std::uint32_t block = kEmpty;
    Sectors valid = 0, dirty = 0;
    std::uint64_t used = 0;  // when, for least recently used
  };

  // What is asked of one block.
  struct Request {
    std::size_t block = ~std::size_t{0};
    StageCounters* counters = nullptr;  // of the stage that asks
    std::uint32_t key = 0;
    Sectors read = 0, write = 0;
    std::array<std::uint32_t, kMaxBlockSectors> written_bytes{};
  };

  static Sectors sectors_of(std::uint32_t first, std::uint32_t bytes) {
    return static_cast<Sectors>((2u << (first + bytes - 1) / kSectorBytes) - (1u << first / kSectorBytes));
  }

  void begin_request(std::uint32_t key, std::size_t block, StageCounters& counters) {
    if (block == request_.block && key == request_.key && &counters == request_.counters) return;
    finish_request();
    request_.block = block;
    request_.key = key;
    request_.counters = &counters;
  }

  void finish_request();
  Line& line_of(std::size_t block, bool overwritten, StageCounters& counters);
  void write_back(const Line& line, StageCounters& counters);

  bool modelled_;
  std::uint32_t block_bytes_;
  Sectors all_sectors_;
  std::size_t sets_, ways_;
  bool has_line_for_each_;  // a cache that has a line for every block evicts none: line i is block i's
  std::vector<Line> lines_;
  std::vector<State> states_;
  CompressedBytes compressed_bytes_;
  Request request_;
  std::uint64_t now_ = 0;
};

}  // namespace beampipe
