#include "pipeline/memory/texture_memory.h"

#include <algorithm>
#include <bit>

namespace beampipe {
namespace {

std::uint64_t bytes_of(Sectors sectors, std::uint32_t sector_bytes) {
  return static_cast<std::uint64_t>(std::popcount(sectors)) * sector_bytes;
}

}  // namespace

ReadCache::ReadCache(const CacheParameters& parameters)
    : sets_(parameters.sets()), ways_(parameters.ways), lines_(sets_ * ways_) {}

Sectors ReadCache::read(std::uint64_t line, Sectors sectors) {
  Line* const set = &lines_[line % sets_ * ways_];
  Line* found = set;  // or the one to replace
  for (Line* way = set; way != set + ways_; ++way) {
    if (way->number == line) {
      found = way;
      break;
    }
    if (way->used < found->used) found = way;
  }
  if (found->number != line) *found = {line, 0, 0};
  const auto missing = static_cast<Sectors>(sectors & ~found->valid);
  found->valid |= sectors;
  found->used = ++now_;
  return missing;
}

void ReadCache::clear() { std::fill(lines_.begin(), lines_.end(), Line{}); }

void TextureFetches::read(const TexelRequests& texels, StageCounters& counters) {
  std::uint64_t asked = 0, missed = 0;
  std::vector<TextureRead>& reads = passes_.back();
  // The layout numbers sectors of the smallest size, in the order of their addresses.
  const std::uint32_t parts = sector_bytes_ / kLeastSectorBytes, parts_per_line = parts * sectors_per_line_;
  texels.for_each([&](std::span<const std::uint64_t> numbers) {
    for (std::size_t i = 0; i < numbers.size();) {
      const std::uint64_t line = numbers[i] / parts_per_line;
      Sectors of_line = 0;
      for (; i < numbers.size() && numbers[i] / parts_per_line == line; ++i)
        of_line |= static_cast<Sectors>(1u << numbers[i] % parts_per_line / parts);
      asked += bytes_of(of_line, sector_bytes_);
      const Sectors missing = l1_.read(line, of_line);
      if (missing == 0) continue;
      missed += bytes_of(missing, sector_bytes_);
      reads.push_back({line, counters.stage.number(), missing});
    }
  });
  counters.sector_bytes += asked;
  counters.texture_sector_bytes += asked;
  counters.l2_bytes += missed;
  counters.texture_l2_bytes += missed;
  constexpr std::size_t kMost = 1 << 14;  // keeps the list short where L1 misses often
  if (reads.size() > 2 * summed_up_ + kMost) sum_up();
}

void TextureFetches::sum_up() {
  std::vector<TextureRead>& reads = passes_.back();
  std::sort(reads.begin(), reads.end(), [](const TextureRead& a, const TextureRead& b) {
    return a.line != b.line ? a.line < b.line : a.stage < b.stage;
  });
  std::size_t kept = 0;
  for (const TextureRead& read : reads) {
    if (kept > 0 && reads[kept - 1].line == read.line && reads[kept - 1].stage == read.stage) {
      reads[kept - 1].sectors |= read.sectors;
    } else {
      reads[kept++] = read;
    }
  }
  reads.resize(kept);
  summed_up_ = kept;
}

void TextureFetches::start_pass() {
  sum_up();
  passes_.emplace_back();
  summed_up_ = 0;
  l1_.clear();
}

TexturePasses TextureFetches::take_passes() {
  sum_up();
  passes_.back().shrink_to_fit();
  return std::move(passes_);
}

std::array<std::uint64_t, kStageNumbers> texture_dram_bytes(const MemoryParameters& memory,
                                                            const std::vector<TexturePasses>& bins,
                                                            const TextureFetch& fetch) {
  std::array<std::uint64_t, kStageNumbers> bytes{};
  std::size_t passes = 0;
  for (const TexturePasses& bin : bins) passes = std::max(passes, bin.size());
  ReadCache l2(memory.l2);
  for (std::size_t pass = 0; pass < passes; ++pass) {
    for (std::size_t bin = 0; bin < bins.size(); ++bin) {
      if (pass >= bins[bin].size()) continue;
      std::vector<TextureRead> fetched;
      for (const TextureRead& read : bins[bin][pass]) {
        const Sectors missing = l2.read(read.line, static_cast<Sectors>(read.sectors));
        bytes[read.stage] += bytes_of(missing, memory.sector_bytes);
        if (fetch && missing != 0) fetched.push_back({read.line, read.stage, missing});
      }
      if (!fetched.empty()) fetch(bin, pass, fetched);
    }
  }
  return bytes;
}

}  // namespace beampipe
