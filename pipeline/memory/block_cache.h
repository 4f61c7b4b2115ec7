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
#include "stages/cost/counters.h"

namespace beampipe {

inline constexpr std::uint32_t kMaxBlockSectors = 8;

using Sectors = std::uint8_t;  // a bit for each sector of a block

// Of bytes [first, first + bytes) of a block.
inline Sectors sectors_of(std::uint32_t first, std::uint32_t bytes) {
  constexpr std::uint32_t kSectorBytes = MemoryParameters::sector_bytes;
  return static_cast<Sectors>((2u << (first + bytes - 1) / kSectorBytes) - (1u << first / kSectorBytes));
}

class BlockCache {
 public:
  // Bytes that a block takes when compressed; its raw size or more: it does not compress.
  using CompressedBytes = std::function<std::uint32_t(std::size_t block)>;

  // Where the cache stands, which says what its bytes are counted as.
  // rop: what it lacks or evicts moves through L2 to and from DRAM; L2 keeps nothing of it, as the surfaces of a frame
  //      are larger.
  // l2:  what is asked of it is L2's, what it lacks or evicts DRAM's.
  enum class Level { rop, l2 };

  // `block_bytes` <= cache.line_bytes, at most kMaxBlockSectors. `cleared`: the state that all blocks start in; else
  // they are raw. An empty `compressed_bytes`: nothing compresses. Where memory is not modelled, nothing is done or
  // counted.
  BlockCache(const MemoryParameters& memory, const CacheParameters& cache, Level level, std::size_t blocks,
             std::uint32_t block_bytes, bool cleared, CompressedBytes compressed_bytes);

  // A cache that is read through, with the blocks of `next`, an L2: asks `next` for the sectors that it lacks.
  // `next` must outlive it.
  BlockCache(const MemoryParameters& memory, const CacheParameters& cache, BlockCache& next);

  // Reads or writes bytes [first, first + bytes) of a block. Accesses of a stage that follow each other with the same
  // block and key (the triangle, usually) are one request, each of whose sectors is asked for once to be read and once
  // to be written. Adds to counters.sector_bytes what is asked for, to counters.l2_bytes what L2 is asked for, and to
  // counters.dram_bytes what is fetched and written back for it. A sector that is written in part is fetched first. No
  // byte is written twice in one request.
  void read(std::uint32_t key, std::size_t block, std::uint32_t first, std::uint32_t bytes, StageCounters& counters) {
    access(key, block, sectors_of(first, bytes), 0, counters, [](auto&&) {});
  }
  void write(std::uint32_t key, std::size_t block, std::uint32_t first, std::uint32_t bytes, StageCounters& counters) {
    access(key, block, 0, sectors_of(first, bytes), counters, [&](auto&& count) { count(first, bytes); });
  }

  // Both, for whoever knows the sectors: each_write(count) calls count(first, bytes) for every run of bytes that is
  // written. It is called only where it matters whether sectors are written as a whole.
  template <class EachWrite>
  void access(std::uint32_t key, std::size_t block, Sectors read, Sectors write, StageCounters& counters,
              EachWrite&& each_write) {
    if (!modelled_) return;
    if (block != request_.block || key != request_.key || &counters != request_.counters)
      begin_request(key, block, counters);
    request_.read |= read;
    request_.write |= write;
    if (write != 0 && request_.counts_bytes)
      each_write([this](std::uint32_t first, std::uint32_t bytes) { count_written(first, bytes); });
  }

  // Serves what has been asked for so far.
  void finish_request();

  // Writes back every dirty line and empties the cache.
  void flush(StageCounters& counters);

  // Reads a whole block past the cache, which is empty.
  void stream_read(std::size_t block, StageCounters& counters) const;

  std::size_t blocks() const { return states_.size(); }

 private:
  static constexpr std::uint32_t kSectorBytes = MemoryParameters::sector_bytes;

  // In memory: kRaw, or the sectors that the block is compressed to; 0: cleared.
  using State = std::uint8_t;
  static constexpr State kRaw = 255;
  static constexpr std::uint32_t kNone = ~0u;

  struct Line {
    std::uint32_t block = kNone;
    Sectors valid = 0, dirty = 0;
    std::uint64_t used = 0;  // when, for least recently used
  };

  // What is asked of one block.
  struct Request {
    std::size_t block = ~std::size_t{0};
    StageCounters* counters = nullptr;  // of the stage that asks
    std::uint32_t key = 0;
    bool counts_bytes = false;  // some sector may have to be fetched unless it is written as a whole
    Sectors read = 0, write = 0;
    std::array<std::uint32_t, kMaxBlockSectors> written_bytes{};
  };

  void begin_request(std::uint32_t key, std::size_t block, StageCounters& counters);
  void count_written(std::uint32_t first, std::uint32_t bytes);
  void serve(std::size_t block, Sectors read, Sectors write, Sectors overwritten, StageCounters& counters);
  Line& make_line(std::size_t block, bool overwritten, StageCounters& counters);
  void write_back(const Line& line, StageCounters& counters);
  void pass_on(std::uint32_t sectors, StageCounters& counters) const;

  bool modelled_;
  Level level_;
  BlockCache* next_ = nullptr;
  std::uint32_t block_bytes_;
  Sectors all_sectors_;
  std::size_t sets_, ways_;
  bool has_line_for_each_;  // a cache that has a line for every block evicts none: line i is block i's
  std::vector<Line> lines_;
  std::vector<std::uint32_t> line_of_;  // by block: which line holds it, or kNone
  std::vector<State> states_;
  CompressedBytes compressed_bytes_;
  Request request_;
  std::uint64_t now_ = 0;
};

}  // namespace beampipe
