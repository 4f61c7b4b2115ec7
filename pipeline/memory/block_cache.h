// A set-associative write-back cache over blocks of memory. It counts the bytes that really move.
//
// In memory a block is cleared (the state alone tells its content), compressed to some number of sectors, or raw. A
// line of the cache holds one block; each sector of the line is valid or not, and dirty or not.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "pipeline/memory/dram_log.h"
#include "pipeline/memory/parameters.h"
#include "simd/population_count.h"
#include "stages/cost/counters.h"

namespace beampipe {

using Sectors = std::uint8_t;  // a bit for each sector of a block

// Of bytes [first, first + bytes) of a block, where a sector has 2^log2_sector bytes.
inline Sectors sectors_of(std::uint32_t first, std::uint32_t bytes, int log2_sector) {
  return static_cast<Sectors>((2u << ((first + bytes - 1) >> log2_sector)) - (1u << (first >> log2_sector)));
}

class BlockCache {
 public:
  // Returns the bytes that a block takes when compressed. Its raw size or more means that it does not compress.
  using CompressedBytes = std::function<std::uint32_t(std::size_t block)>;

  // Where the cache stands, which decides how its bytes are counted.
  // rop: misses and evictions move through L2 to and from DRAM. L2 keeps none of them, because the surfaces of a frame
  //      are larger than L2.
  // l2:  requests count as L2 bytes, misses and evictions as DRAM bytes.
  enum class Level { rop, l2 };

  // A framebuffer on chip has no cache.
  static bool is_modelled(const MemoryParameters& memory, Level level) {
    return level == Level::rop ? memory.models_framebuffer() : memory.modelled;
  }

  // The blocks that a cache holds some of.
  struct Blocks {
    std::size_t count = 0;
    std::uint32_t bytes = 0;                // of each; <= cache.line_bytes, at most kMaxBlockSectors sectors
    bool cleared = false;                   // all start out cleared, else raw
    CompressedBytes compressed_bytes = {};  // empty: nothing compresses
    BlockPlaces places = {};                // where they lie, for records of DRAM requests; a block begins with a line
  };

  // If it is not modelled, all calls do nothing.
  BlockCache(const MemoryParameters& memory, const CacheParameters& cache, Level level, Blocks blocks);

  // A read-only cache in front of `next`, an L2, with the same blocks. It asks `next` for the sectors that it lacks.
  // `next` must outlive it.
  BlockCache(const MemoryParameters& memory, const CacheParameters& cache, BlockCache& next);

  // Reads or writes bytes [first, first + bytes) of a block. Consecutive accesses of a stage with the same block and
  // key (usually the triangle) form one request, which asks for each sector at most once to read and once to write.
  // Adds the request to counters.sector_bytes, what L2 is asked for to counters.l2_bytes, and what is fetched and
  // written back to counters.dram_bytes. A sector that is written only in part is fetched first. No byte is written
  // twice in one request.
  void read(std::uint32_t key, std::size_t block, std::uint32_t first, std::uint32_t bytes, StageCounters& counters) {
    access(key, block, sectors_of(first, bytes, log2_sector_), 0, counters, [](auto&&) {});
  }
  void write(std::uint32_t key, std::size_t block, std::uint32_t first, std::uint32_t bytes, StageCounters& counters) {
    access(key, block, 0, sectors_of(first, bytes, log2_sector_), counters, [&](auto&& count) { count(first, bytes); });
  }

  // Reads and writes, for a caller that already knows the sectors. each_write(count) calls count(first, bytes) for
  // every run of bytes that is written; it is only called where it matters whether sectors are written as a whole.
  template <class EachWrite>
  void access(std::uint32_t key, std::size_t block, Sectors read, Sectors write, StageCounters& counters,
              EachWrite&& each_write) {
    if (!modelled_) return;
    if (block != request_.block || key != request_.key || counters.stage != request_.counters->stage)
      begin_request(key, block, counters);
    request_.read |= read;
    request_.write |= write;
    if (write != 0 && request_.counts_bytes) [[unlikely]]
      each_write([this](std::uint32_t first, std::uint32_t bytes) { count_written(first, bytes); });
  }

  // `times` reads that are a request each, whatever was asked for last. Between them the caller may have read other
  // blocks, at most ways() in all, so that only the first read can miss.
  void fetch(std::size_t block, std::uint32_t first, std::uint32_t bytes, std::uint64_t times,
             StageCounters& counters) {
    if (!modelled_) return;
    finish_request();
    const Sectors sectors = sectors_of(first, bytes, log2_sector_);
    const std::uint32_t count = ((first + bytes - 1) >> log2_sector_) - (first >> log2_sector_) + 1;
    count_request(block, times * count << log2_sector_, counters);
    serve(block, sectors, 0, 0, counters);
  }

  // Serves the request that is still open.
  void finish_request() {
    if ((request_.read | request_.write) == 0) return;
    const std::uint32_t place = line_of_[request_.block];
    if (request_.counts_bytes || place == kNone || lines_[place].valid != all_sectors_) return serve_request();
    count_request(request_.block, bytes_of(request_.read, request_.write), *request_.counters);
    lines_[place].dirty |= request_.write;
    if (lines_[place].newer != kNone) use(lines_[place]);
    close_request();
  }

  // Writes back every dirty line and empties the cache.
  void flush(StageCounters& counters);

  // Reads a whole block without going through the cache, which must be empty.
  void stream_read(std::size_t block, StageCounters& counters);

  std::size_t blocks() const { return states_.size(); }
  std::size_t ways() const { return ways_; }

 private:
  std::uint32_t sector_bytes() const { return 1u << log2_sector_; }
  std::uint32_t sectors_in(std::uint32_t bytes) const { return (bytes + sector_bytes() - 1) >> log2_sector_; }
  std::uint64_t bytes_of(Sectors sectors) const { return std::uint64_t{population_count(sectors)} << log2_sector_; }
  std::uint64_t bytes_of(Sectors read, Sectors write) const {
    return std::uint64_t{population_count(read | std::uint32_t{write} << 8)} << log2_sector_;
  }

  // State of a block in memory: kRaw, or the number of sectors that it is compressed to; 0 means cleared.
  using State = std::uint8_t;
  static constexpr State kRaw = 255;
  static constexpr std::uint32_t kNone = ~0u;

  struct Line {
    std::uint32_t block = kNone;
    Sectors valid = 0, dirty = 0;
    std::uint32_t newer = kNone, older = kNone;  // lines of its set, by their last use; the set's ends have kNone
  };

  // The lines of a set that were used last and longest ago.
  struct Set {
    std::uint32_t newest, oldest;
  };

  // The open request: what has been asked of one block so far.
  struct Request {
    std::size_t block = ~std::size_t{0};
    StageCounters* counters = nullptr;  // of the stage that asks; null before the first request
    std::uint32_t key = 0;
    bool counts_bytes = false;  // a sector may have to be fetched unless all of it is written
    Sectors read = 0, write = 0;
    std::array<std::uint32_t, kMaxBlockSectors> written_bytes{};
  };

  void count_request(std::size_t block, std::uint64_t bytes, StageCounters& counters) const {
    counters.sector_bytes += bytes;
    if (level_ == Level::l2 && !next_) count_l2(block, bytes, counters);
  }
  void count_l2(std::size_t block, std::uint64_t bytes, StageCounters& counters) const {
    counters.l2_bytes += bytes;
    if (places_.tally) places_.tally->add_l2(places_.array_of(block), counters.stage, bytes);
  }
  void begin_request(std::uint32_t key, std::size_t block, StageCounters& counters) {
    finish_request();
    request_.block = block;
    request_.key = key;
    request_.counters = &counters;
    const std::uint32_t place = line_of_[block];
    request_.counts_bytes = place == kNone ? states_[block] != 0 : lines_[place].valid != all_sectors_;
  }
  void close_request() {
    request_.block = ~std::size_t{0};
    request_.read = request_.write = 0;
  }
  void count_written(std::uint32_t first, std::uint32_t bytes);
  void serve_request();
  void serve(std::size_t block, Sectors read, Sectors write, Sectors overwritten, StageCounters& counters) {
    const std::uint32_t place = line_of_[block];
    Line& line = place != kNone ? lines_[place] : make_line(block, overwritten == all_sectors_ && read == 0, counters);
    const auto missing = static_cast<Sectors>((read | (write & ~overwritten)) & ~line.valid);
    if (missing != 0) load(block, missing, counters);
    line.valid |= missing | write;
    line.dirty |= write;
    if (line.newer != kNone) use(line);
  }
  void load(std::size_t block, Sectors missing, StageCounters& counters);
  Line& make_line(std::size_t block, bool overwritten, StageCounters& counters);
  void link_lines();
  void use(Line& line);
  void write_back(const Line& line, StageCounters& counters);
  void pass_on(DramAccess access, std::size_t block, Sectors sectors, bool compressed, StageCounters& counters);
  void record(DramAccess access, std::size_t block, Sectors sectors, const StageCounters& counters);

  bool modelled_;
  int log2_sector_;
  Level level_;
  BlockCache* next_ = nullptr;
  std::uint32_t block_bytes_;
  Sectors all_sectors_;
  std::size_t sets_, ways_;
  bool has_line_for_each_;  // one line per block: line i holds block i and nothing is evicted
  std::vector<Line> lines_;
  std::vector<Set> lru_;                // by set; empty if nothing is evicted
  std::vector<std::uint32_t> line_of_;  // by block: which line holds it, or kNone
  std::vector<State> states_;
  CompressedBytes compressed_bytes_;
  Request request_;
  BlockPlaces places_;
  std::uint32_t sectors_per_line_;
  // Of the recorded requests: has this cache written since it was last empty, and which pass can read that again?
  bool wrote_ = false;
  std::uint32_t next_pass_ = 0;
};

}  // namespace beampipe
