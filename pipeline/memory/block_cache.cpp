#include "pipeline/memory/block_cache.h"

#include <bit>
#include <stdexcept>

namespace beampipe {
namespace {

// The base instruction set has no population count.
constexpr std::array<std::uint8_t, 256> kBits = [] {
  std::array<std::uint8_t, 256> bits{};
  for (std::uint32_t i = 0; i < bits.size(); ++i) bits[i] = static_cast<std::uint8_t>(std::popcount(i));
  return bits;
}();

}  // namespace

BlockCache::BlockCache(const MemoryParameters& memory, const CacheParameters& cache, std::size_t blocks,
                       std::uint32_t block_bytes, bool cleared, CompressedBytes compressed_bytes)
    : modelled_(memory.modelled), block_bytes_(block_bytes), ways_(cache.ways) {
  const std::uint32_t sectors = (block_bytes + kSectorBytes - 1) / kSectorBytes;
  if (sectors == 0 || sectors > kMaxBlockSectors || block_bytes > cache.line_bytes)
    throw std::invalid_argument("a block must fill at least one sector and at most one cache line");
  all_sectors_ = static_cast<Sectors>((1u << sectors) - 1);
  sets_ = std::max<std::size_t>(cache.bytes / (cache.line_bytes * cache.ways), 1);
  has_line_for_each_ = blocks <= sets_ * ways_;
  if (!modelled_) return;
  if (memory.compression) compressed_bytes_ = std::move(compressed_bytes);
  states_.assign(blocks, cleared ? State{0} : kRaw);
  lines_.resize(has_line_for_each_ ? blocks : sets_ * ways_);
}

void BlockCache::finish_request() {
  Request& request = request_;
  if ((request.read | request.write) == 0) return;
  StageCounters& counters = *request.counters;
  std::uint32_t overwritten = 0;
  for (std::uint32_t left = request.write; left != 0; left &= left - 1) {
    const auto sector = static_cast<std::uint32_t>(std::countr_zero(left));
    const std::uint32_t whole = std::min(kSectorBytes, block_bytes_ - sector * kSectorBytes);
    if (request.written_bytes[sector] >= whole) overwritten |= 1u << sector;
    request.written_bytes[sector] = 0;
  }
  counters.sector_bytes += (kBits[request.read] + kBits[request.write]) * kSectorBytes;
  Line& line = line_of(request.block, overwritten == all_sectors_ && request.read == 0, counters);
  const auto missing = static_cast<Sectors>((request.read | (request.write & ~overwritten)) & ~line.valid);
  counters.dram_bytes += kBits[missing] * kSectorBytes;
  line.valid |= missing | request.write;
  line.dirty |= request.write;
  line.used = ++now_;
  request.block = ~std::size_t{0};
  request.read = request.write = 0;
}

BlockCache::Line& BlockCache::line_of(std::size_t block, bool overwritten, StageCounters& counters) {
  Line* victim;
  if (has_line_for_each_) {
    victim = &lines_[block];
    if (victim->block == block) return *victim;
  } else {
    Line* const set = &lines_[block % sets_ * ways_];
    victim = set;
    for (Line* line = set; line != set + ways_; ++line) {
      if (line->block == block) return *line;
      if (line->used < victim->used) victim = line;
    }
    if (victim->block != kEmpty) write_back(*victim, counters);
  }
  *victim = {static_cast<std::uint32_t>(block), 0, 0, 0};
  const State state = states_[block];
  if (state != kRaw && !overwritten) {  // a cleared block is known; a compressed one is fetched and unpacked as a whole
    counters.dram_bytes += state * kSectorBytes;
    victim->valid = all_sectors_;
  }
  return *victim;
}

void BlockCache::write_back(const Line& line, StageCounters& counters) {
  if (line.dirty == 0) return;
  State& state = states_[line.block];
  if (compressed_bytes_ && line.valid == all_sectors_) {
    const std::uint32_t sectors = (compressed_bytes_(line.block) + kSectorBytes - 1) / kSectorBytes;
    if (sectors < kBits[all_sectors_]) {
      counters.dram_bytes += sectors * kSectorBytes;
      state = static_cast<State>(sectors);
      return;
    }
  }
  const Sectors written = state == kRaw ? line.dirty : all_sectors_;
  counters.dram_bytes += kBits[written] * kSectorBytes;
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
  const std::uint32_t raw = kBits[all_sectors_] * kSectorBytes;
  const State state = states_[block];
  counters.sector_bytes += raw;
  counters.dram_bytes += state == kRaw ? raw : state * kSectorBytes;
}

}  // namespace beampipe
