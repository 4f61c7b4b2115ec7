// Memory traffic of textures: texels go through the L1 of the multiprocessor that works on the bin, then through L2.
//
// Bins share textures, so L2 keeps texels from bin to bin, as no other class of data does. Which bin is drawn earlier
// matters there. So bins list what they ask L2 for, and when all are finished, the lists go through L2 in the order of
// the bins, whatever thread made them.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "pipeline/memory/block_cache.h"
#include "pipeline/memory/parameters.h"
#include "stages/cost/counters.h"
#include "stages/surface/texel_requests.h"

namespace beampipe {

// A read-only, set-associative cache that replaces the least recently used line. Unlike BlockCache it keeps nothing for
// lines that it does not hold, so the memory behind it may be of any size.
class ReadCache {
 public:
  explicit ReadCache(const CacheParameters& parameters);

  // Asks for sectors of a line. Returns those that it did not hold; it holds them now.
  Sectors read(std::uint64_t line, Sectors sectors);

  void clear();

 private:
  struct Line {
    std::uint64_t number = ~std::uint64_t{0};
    std::uint64_t used = 0;  // when
    Sectors valid = 0;
  };

  std::size_t sets_, ways_;
  std::vector<Line> lines_;  // set by set
  std::uint64_t now_ = 0;
};

// Sectors of a line that a stage of a bin asks L2 for.
struct TextureRead {
  std::uint64_t line : 48;
  std::uint64_t stage : 8;  // Stage::number()
  std::uint64_t sectors : 8;
};
using TexturePasses = std::vector<std::vector<TextureRead>>;  // by pass of the bin over the frame; each line once

// The texels of a bin.
class TextureFetches {
 public:
  explicit TextureFetches(const MemoryParameters& memory)
      : sector_bytes_(memory.sector_bytes), sectors_per_line_(memory.sectors_per_line()), l1_(memory.l1) {}

  // Puts what was asked for through L1, which it adds to counters.sector_bytes and l2_bytes.
  void read(const TexelRequests& texels, StageCounters& counters);

  // The next pass over the frame comes to this bin after all others.
  void start_pass();

  // What L2 is asked for. Call it once, at the end.
  TexturePasses take_passes();

 private:
  void sum_up();

  std::uint32_t sector_bytes_, sectors_per_line_;
  ReadCache l1_;
  TexturePasses passes_ = {{}};
  std::size_t summed_up_ = 0;  // reads of this pass that name each line once
};

// The bytes that DRAM is asked for when all passes over the frame have gone through L2: by
// Stage::number(). `bins`: in the order in which they are drawn. If there is such a function, calls fetch(bin, pass,
// reads) with what L2 lacks.
using TextureFetch = std::function<void(std::size_t bin, std::size_t pass, const std::vector<TextureRead>& reads)>;
std::array<std::uint64_t, kStageNumbers> texture_dram_bytes(const MemoryParameters& memory,
                                                            const std::vector<TexturePasses>& bins,
                                                            const TextureFetch& fetch = nullptr);

}  // namespace beampipe
