#include "pipeline/memory/block_cache.h"

#include <bit>
#include <stdexcept>

#include "simd/population_count.h"

namespace beampipe {
namespace {

// Where the bytes of a compressed block lie.
Sectors first_sectors(std::uint32_t count) { return static_cast<Sectors>((1u << count) - 1); }

}  // namespace

BlockCache::BlockCache(const MemoryParameters& memory, const CacheParameters& cache, Level level, std::size_t blocks,
                       std::uint32_t block_bytes, bool cleared, CompressedBytes compressed_bytes, BlockPlaces places)
    : modelled_(is_modelled(memory, level)),
      log2_sector_(std::countr_zero(memory.sector_bytes)),
      level_(level),
      block_bytes_(block_bytes),
      ways_(cache.ways),
      places_(std::move(places)),
      sectors_per_line_(cache.line_bytes >> log2_sector_) {
  const std::uint32_t sectors = sectors_in(block_bytes);
  if (sectors == 0 || sectors > kMaxBlockSectors || block_bytes > cache.line_bytes)
    throw std::invalid_argument("a block must fill at least one sector and at most one cache line");
  all_sectors_ = static_cast<Sectors>((1u << sectors) - 1);
  sets_ = cache.sets();
  has_line_for_each_ = blocks <= sets_ * ways_;
  if (!modelled_) return;
  if (memory.compression) compressed_bytes_ = std::move(compressed_bytes);
  states_.assign(blocks, cleared ? State{0} : kRaw);
  lines_.resize(has_line_for_each_ ? blocks : sets_ * ways_);
  line_of_.assign(blocks, kNone);
  if (places_.log && places_.lines.empty())
    places_.log->reserve(places_.array, std::uint64_t{blocks} * sectors_per_line_);
}

BlockCache::BlockCache(const MemoryParameters& memory, const CacheParameters& cache, BlockCache& next)
    : BlockCache(memory, cache, Level::l2, next.blocks(), next.block_bytes_, false, nullptr) {
  next_ = &next;
}

std::uint64_t BlockCache::bytes_of(Sectors sectors) const {
  return std::uint64_t{population_count(sectors)} << log2_sector_;
}

void BlockCache::begin_request(std::uint32_t key, std::size_t block, StageCounters& counters) {
  finish_request();
  request_.block = block;
  request_.key = key;
  request_.counters = &counters;
  const std::uint32_t line = line_of_[block];
  request_.counts_bytes = line == kNone ? states_[block] != 0 : lines_[line].valid != all_sectors_;
}

void BlockCache::count_written(std::uint32_t first, std::uint32_t bytes) {
  const std::uint32_t end = first + bytes;
  for (std::uint32_t at = first; at < end;) {
    const std::uint32_t sector = at >> log2_sector_, stop = std::min(end, (sector + 1) << log2_sector_);
    request_.written_bytes[sector] += stop - at;
    at = stop;
  }
}

void BlockCache::finish_request() {
  Request& request = request_;
  if ((request.read | request.write) == 0) return;
  StageCounters& counters = *request.counters;
  std::uint32_t overwritten = 0;
  for (std::uint32_t left = request.counts_bytes ? request.write : 0; left != 0; left &= left - 1) {
    const auto sector = static_cast<std::uint32_t>(std::countr_zero(left));
    const std::uint32_t whole = std::min(sector_bytes(), block_bytes_ - (sector << log2_sector_));
    if (request.written_bytes[sector] >= whole) overwritten |= 1u << sector;
    request.written_bytes[sector] = 0;
  }
  const std::uint64_t bytes = bytes_of(request.read) + bytes_of(request.write);
  counters.sector_bytes += bytes;
  if (level_ == Level::l2 && !next_) counters.l2_bytes += bytes;
  serve(request.block, request.read, request.write, static_cast<Sectors>(overwritten), counters);
  request.block = ~std::size_t{0};
  request.read = request.write = 0;
}

void BlockCache::serve(std::size_t block, Sectors read, Sectors write, Sectors overwritten, StageCounters& counters) {
  Line& line = line_of_[block] != kNone ? lines_[line_of_[block]]
                                        : make_line(block, overwritten == all_sectors_ && read == 0, counters);
  const auto missing = static_cast<Sectors>((read | (write & ~overwritten)) & ~line.valid);
  if (missing != 0 && next_) {
    counters.l2_bytes += bytes_of(missing);
    next_->serve(block, missing, 0, 0, counters);
  } else {
    pass_on(DramAccess::read, block, missing, counters);
  }
  line.valid |= missing | write;
  line.dirty |= write;
  line.used = ++now_;
}

BlockCache::Line& BlockCache::make_line(std::size_t block, bool overwritten, StageCounters& counters) {
  std::size_t place = block;
  if (!has_line_for_each_) {
    const std::size_t set = block % sets_ * ways_;
    place = set;
    for (std::size_t line = set; line < set + ways_; ++line)
      if (lines_[line].used < lines_[place].used) place = line;
    if (lines_[place].block != kNone) {
      write_back(lines_[place], counters);
      line_of_[lines_[place].block] = kNone;
    }
  }
  line_of_[block] = static_cast<std::uint32_t>(place);
  Line& line = lines_[place];
  line = {static_cast<std::uint32_t>(block), 0, 0, 0};
  const State state = states_[block];
  // A cleared block needs no fetch; a compressed one is fetched and unpacked whole.
  if (state != kRaw && !overwritten) {
    pass_on(DramAccess::read, block, first_sectors(state), counters);
    line.valid = all_sectors_;
  }
  return line;
}

void BlockCache::write_back(const Line& line, StageCounters& counters) {
  if (line.dirty == 0) return;
  State& state = states_[line.block];
  if (compressed_bytes_ && line.valid == all_sectors_) {
    const std::uint32_t sectors = sectors_in(compressed_bytes_(line.block));
    if (sectors < population_count(all_sectors_)) {
      pass_on(DramAccess::write, line.block, first_sectors(sectors), counters);
      state = static_cast<State>(sectors);
      return;
    }
  }
  const Sectors written = state == kRaw ? line.dirty : all_sectors_;
  pass_on(DramAccess::write, line.block, written, counters);
  state = kRaw;
}

// To or from the next level.
void BlockCache::pass_on(DramAccess access, std::size_t block, Sectors sectors, StageCounters& counters) {
  counters.dram_bytes += bytes_of(sectors);
  if (level_ == Level::rop) counters.l2_bytes += bytes_of(sectors);
  if (places_.log && sectors != 0) record(access, block, sectors, counters);
}

void BlockCache::record(DramAccess access, std::size_t block, Sectors sectors, const StageCounters& counters) {
  places_.log->reach_pass(next_pass_);
  wrote_ |= access == DramAccess::write;
  const BlockPlaces::Line line = places_.lines.empty() ? BlockPlaces::Line{places_.array, block} : places_.lines[block];
  for (std::uint32_t left = sectors; left != 0;) {
    const auto first = static_cast<std::uint32_t>(std::countr_zero(left));
    const auto run = static_cast<std::uint32_t>(std::countr_one(left >> first));
    places_.log->add(line.array, access, line.number * sectors_per_line_ + first, run, counters);
    left &= ~(((1u << run) - 1) << first);
  }
}

void BlockCache::flush(StageCounters& counters) {
  finish_request();
  for (Line& line : lines_) {
    if (line.block == kNone) continue;
    write_back(line, counters);
    line_of_[line.block] = kNone;
    line = {};
  }
  if (wrote_) next_pass_ = places_.log->pass() + 1;
  wrote_ = false;
}

void BlockCache::stream_read(std::size_t block, StageCounters& counters) {
  if (!modelled_) return;
  const std::uint64_t raw = bytes_of(all_sectors_);
  const State state = states_[block];
  counters.sector_bytes += raw;
  if (level_ == Level::l2) counters.l2_bytes += raw;
  pass_on(DramAccess::read, block, state == kRaw ? all_sectors_ : first_sectors(state), counters);
}

}  // namespace beampipe
