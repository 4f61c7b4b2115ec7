#include "pipeline/memory/block_cache.h"

#include <algorithm>
#include <bit>
#include <stdexcept>

namespace beampipe {
namespace {

std::uint64_t count_bits(std::uint32_t mask) { return static_cast<std::uint64_t>(std::popcount(mask)); }

}  // namespace

BlockCache::BlockCache(const MemoryParameters& memory, const CacheParameters& cache, std::size_t blocks,
                       std::uint32_t block_bytes, bool cleared, CompressedBytes compressed_bytes)
    : modelled_(memory.modelled),
      sector_bytes_(memory.sector_bytes),
      block_bytes_(block_bytes),
      ways_(cache.ways),
      states_(blocks, cleared ? State{0} : kRaw) {
  if (memory.compression) compressed_bytes_ = std::move(compressed_bytes);
  const std::uint32_t sectors = (block_bytes + sector_bytes_ - 1) / sector_bytes_;
  if (sectors == 0 || sectors > kMaxBlockSectors || block_bytes > cache.line_bytes)
    throw std::invalid_argument("a block must fill at least one sector and at most one cache line");
  all_sectors_ = ~0u >> (kMaxBlockSectors - sectors);
  sets_ = std::max<std::size_t>(cache.bytes / (cache.line_bytes * cache.ways), 1);
  sets_ = std::min(sets_, std::max<std::size_t>(blocks, 1));  // sets beyond the last block would stay empty
  if (modelled_) lines_.resize(sets_ * ways_);
}

void BlockCache::read(std::uint32_t key, std::size_t block, std::uint32_t first, std::uint32_t bytes,
                      StageCounters& counters) {
  if (!modelled_) return;
  begin_request(key, block, counters);
  for (std::uint32_t sector = first / sector_bytes_; sector * sector_bytes_ < first + bytes; ++sector)
    request_.read |= 1u << sector;
}

void BlockCache::write(std::uint32_t key, std::size_t block, std::uint32_t first, std::uint32_t bytes,
                       StageCounters& counters) {
  if (!modelled_) return;
  begin_request(key, block, counters);
  const std::uint32_t end = first + bytes;
  for (std::uint32_t sector = first / sector_bytes_; sector * sector_bytes_ < end; ++sector) {
    request_.write |= 1u << sector;
    request_.written_bytes[sector] +=
        std::min(end, (sector + 1) * sector_bytes_) - std::max(first, sector * sector_bytes_);
  }
}

void BlockCache::begin_request(std::uint32_t key, std::size_t block, StageCounters& counters) {
  if (block == request_.block && key == request_.key && &counters == request_.counters) return;
  finish_request();
  request_.block = block;
  request_.key = key;
  request_.counters = &counters;
}

void BlockCache::finish_request() {
  Request& request = request_;
  if ((request.read | request.write) == 0) return;
  StageCounters& counters = *request.counters;
  std::uint32_t overwritten = 0;
  for (std::uint32_t left = request.write; left != 0; left &= left - 1) {
    const auto sector = static_cast<std::uint32_t>(std::countr_zero(left));
    const std::uint32_t whole = std::min(sector_bytes_, block_bytes_ - sector * sector_bytes_);
    if (request.written_bytes[sector] >= whole) overwritten |= 1u << sector;
    request.written_bytes[sector] = 0;
  }
  counters.sector_bytes += (count_bits(request.read) + count_bits(request.write)) * sector_bytes_;
  Line& line = line_of(request.block, overwritten == all_sectors_ && request.read == 0, counters);
  const std::uint32_t missing = (request.read | (request.write & ~overwritten)) & ~line.valid;
  counters.dram_bytes += count_bits(missing) * sector_bytes_;
  line.valid |= missing | request.write;
  line.dirty |= request.write;
  line.used = ++now_;
  request.block = ~std::size_t{0};
  request.read = request.write = 0;
}

BlockCache::Line& BlockCache::line_of(std::size_t block, bool overwritten, StageCounters& counters) {
  Line* const set = &lines_[block % sets_ * ways_];
  Line* victim = set;
  for (Line* line = set; line != set + ways_; ++line) {
    if (line->block == block) return *line;
    if (line->used < victim->used) victim = line;
  }
  if (victim->block != kEmpty) write_back(*victim, counters);
  *victim = {static_cast<std::uint32_t>(block), 0, 0, 0};
  const State state = states_[block];
  if (state != kRaw && !overwritten) {  // a cleared block is known; a compressed one is fetched and unpacked as a whole
    counters.dram_bytes += std::uint64_t{state} * sector_bytes_;
    victim->valid = all_sectors_;
  }
  return *victim;
}

void BlockCache::write_back(const Line& line, StageCounters& counters) {
  if (line.dirty == 0) return;
  State& state = states_[line.block];
  const auto raw_sectors = static_cast<std::uint32_t>(std::popcount(all_sectors_));
  if (compressed_bytes_ && line.valid == all_sectors_) {
    const std::uint32_t sectors = (compressed_bytes_(line.block) + sector_bytes_ - 1) / sector_bytes_;
    if (sectors < raw_sectors) {
      counters.dram_bytes += std::uint64_t{sectors} * sector_bytes_;
      state = static_cast<State>(sectors);
      return;
    }
  }
  const std::uint32_t written = state == kRaw ? line.dirty : all_sectors_;
  counters.dram_bytes += count_bits(written) * sector_bytes_;
  state = kRaw;
}

void BlockCache::flush(StageCounters& counters) {
  finish_request();
  for (Line& line : lines_) {
    if (line.block == kEmpty) continue;
    write_back(line, counters);
    line = {};
  }
}

void BlockCache::stream_read(std::size_t block, StageCounters& counters) const {
  if (!modelled_) return;
  const auto raw = count_bits(all_sectors_) * sector_bytes_;
  const State state = states_[block];
  counters.sector_bytes += raw;
  counters.dram_bytes += state == kRaw ? raw : std::uint64_t{state} * sector_bytes_;
}

}  // namespace beampipe
