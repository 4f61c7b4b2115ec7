#include "pipeline/memory/block_cache.h"

#include <bit>
#include <stdexcept>

namespace beampipe {
namespace {

// Where the bytes of a compressed block lie.
Sectors first_sectors(std::uint32_t count) { return static_cast<Sectors>((1u << count) - 1); }

}  // namespace

BlockCache::BlockCache(const MemoryParameters& memory, const CacheParameters& cache, Level level, Blocks blocks)
    : modelled_(is_modelled(memory, level)),
      log2_sector_(std::countr_zero(memory.sector_bytes)),
      level_(level),
      block_bytes_(blocks.bytes),
      ways_(cache.ways),
      places_(std::move(blocks.places)),
      sectors_per_line_(cache.line_bytes >> log2_sector_) {
  const std::uint32_t sectors = sectors_in(block_bytes_);
  if (sectors == 0 || sectors > kMaxBlockSectors || block_bytes_ > cache.line_bytes)
    throw std::invalid_argument("a block must fill at least one sector and at most one cache line");
  all_sectors_ = static_cast<Sectors>((1u << sectors) - 1);
  sets_ = cache.sets();
  has_line_for_each_ = blocks.count <= sets_ * ways_;
  if (!modelled_) return;
  if (memory.compression) compressed_bytes_ = std::move(blocks.compressed_bytes);
  states_.assign(blocks.count, blocks.cleared ? State{0} : kRaw);
  lines_.resize(has_line_for_each_ ? blocks.count : sets_ * ways_);
  link_lines();
  line_of_.assign(blocks.count, kNone);
  if (places_.log && places_.lines.empty())
    places_.log->reserve(places_.array, std::uint64_t{blocks.count} * sectors_per_line_);
}

BlockCache::BlockCache(const MemoryParameters& memory, const CacheParameters& cache, BlockCache& next)
    : BlockCache(memory, cache, Level::l2, {.count = next.blocks(), .bytes = next.block_bytes_}) {
  next_ = &next;
}

// The first line of each set becomes the one to fill first.
void BlockCache::link_lines() {
  if (has_line_for_each_) return;
  lru_.clear();
  for (std::uint32_t place = 0; place < lines_.size(); ++place) {
    const bool first = place % ways_ == 0, last = (place + 1) % ways_ == 0;
    lines_[place].older = first ? kNone : place - 1;
    lines_[place].newer = last ? kNone : place + 1;
    if (last) lru_.push_back({place, static_cast<std::uint32_t>(place + 1 - ways_)});
  }
}

void BlockCache::count_written(std::uint32_t first, std::uint32_t bytes) {
  const std::uint32_t end = first + bytes;
  for (std::uint32_t at = first; at < end;) {
    const std::uint32_t sector = at >> log2_sector_, stop = std::min(end, (sector + 1) << log2_sector_);
    request_.written_bytes[sector] += stop - at;
    at = stop;
  }
}

void BlockCache::serve_request() {
  Request& request = request_;
  StageCounters& counters = *request.counters;
  std::uint32_t overwritten = 0;
  for (std::uint32_t left = request.counts_bytes ? request.write : 0; left != 0; left &= left - 1) {
    const auto sector = static_cast<std::uint32_t>(std::countr_zero(left));
    const std::uint32_t whole = std::min(sector_bytes(), block_bytes_ - (sector << log2_sector_));
    if (request.written_bytes[sector] >= whole) overwritten |= 1u << sector;
    request.written_bytes[sector] = 0;
  }
  count_request(request.block, bytes_of(request.read, request.write), counters);
  serve(request.block, request.read, request.write, static_cast<Sectors>(overwritten), counters);
  close_request();
}

void BlockCache::load(std::size_t block, Sectors missing, StageCounters& counters) {
  if (!next_) return pass_on(DramAccess::read, block, missing, false, counters);
  next_->count_l2(block, bytes_of(missing), counters);
  next_->serve(block, missing, 0, 0, counters);
}

// Moves a line to the newest end of its set.
void BlockCache::use(Line& line) {
  Set& set = lru_[line.block % sets_];
  const auto place = static_cast<std::uint32_t>(&line - lines_.data());
  lines_[line.newer].older = line.older;
  (line.older == kNone ? set.oldest : lines_[line.older].newer) = line.newer;
  line.newer = kNone;
  line.older = set.newest;
  lines_[set.newest].newer = place;
  set.newest = place;
}

BlockCache::Line& BlockCache::make_line(std::size_t block, bool overwritten, StageCounters& counters) {
  std::size_t place = block;
  if (!has_line_for_each_) {
    place = lru_[block % sets_].oldest;
    if (lines_[place].block != kNone) {
      write_back(lines_[place], counters);
      line_of_[lines_[place].block] = kNone;
    }
  }
  line_of_[block] = static_cast<std::uint32_t>(place);
  Line& line = lines_[place];
  line.block = static_cast<std::uint32_t>(block);
  line.valid = line.dirty = 0;
  const State state = states_[block];
  // A cleared block needs no fetch; a compressed one is fetched and unpacked whole.
  if (state != kRaw && !overwritten) {
    pass_on(DramAccess::read, block, first_sectors(state), true, counters);
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
      pass_on(DramAccess::write, line.block, first_sectors(sectors), true, counters);
      state = static_cast<State>(sectors);
      return;
    }
  }
  const Sectors written = state == kRaw ? line.dirty : all_sectors_;
  pass_on(DramAccess::write, line.block, written, false, counters);
  state = kRaw;
}

// To or from the next level.
void BlockCache::pass_on(DramAccess access, std::size_t block, Sectors sectors, bool compressed,
                         StageCounters& counters) {
  if (sectors == 0) return;
  const std::uint64_t bytes = bytes_of(sectors);
  counters.dram_bytes += bytes;
  if (level_ == Level::rop) count_l2(block, bytes, counters);
  if (places_.tally) places_.tally->add(places_.array_of(block), access, counters.stage, bytes, compressed);
  if (places_.log) record(access, block, sectors, counters);
}

void BlockCache::record(DramAccess access, std::size_t block, Sectors sectors, const StageCounters& counters) {
  places_.log->reach_pass(next_pass_);
  wrote_ |= access == DramAccess::write;
  const BlockPlaces::Line line = places_.lines.empty() ? BlockPlaces::Line{places_.array, block} : places_.lines[block];
  for (std::uint32_t left = sectors; left != 0;) {
    const auto first = static_cast<std::uint32_t>(std::countr_zero(left));
    const auto run = static_cast<std::uint32_t>(std::countr_one(left >> first));
    places_.log->add(line.array, access, line.number * sectors_per_line_ + first, run, counters.stage);
    left &= ~(((1u << run) - 1) << first);
  }
}

void BlockCache::flush(StageCounters& counters) {
  finish_request();
  for (Line& line : lines_) {
    if (line.block == kNone) continue;
    write_back(line, counters);
    line_of_[line.block] = kNone;
    line.block = kNone;
  }
  link_lines();
  if (wrote_) next_pass_ = places_.log->pass() + 1;
  wrote_ = false;
}

void BlockCache::stream_read(std::size_t block, StageCounters& counters) {
  if (!modelled_) return;
  const std::uint64_t raw = bytes_of(all_sectors_);
  const State state = states_[block];
  counters.sector_bytes += raw;
  if (level_ == Level::l2) count_l2(block, raw, counters);
  pass_on(DramAccess::read, block, state == kRaw ? all_sectors_ : first_sectors(state), state != kRaw, counters);
}

}  // namespace beampipe
