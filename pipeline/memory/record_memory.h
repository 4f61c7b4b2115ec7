// The pool of a bin's records in memory, where pixels are not on chip.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "pipeline/memory/tile_surface.h"
#include "stages/data/pooled_pixels.h"

namespace beampipe {

// A pixel's first chunks lie in its own share of the pool, and those that find no room there in the shares of the
// pixels that follow.
class RecordMemory {
 public:
  // `name`: as in TileSurface. `order` must outlive it.
  RecordMemory(const MemorySystem& memory, std::string_view name, const ZOrder& order, std::uint32_t bytes_per_pixel);

  void access(const RecordVisit& visit, StageCounters& counters);

  // The end of a pass: everything goes back to memory.
  void flush(StageCounters& counters) { surface_.flush(counters); }

  // Adds the logical bytes that were read and written, to the pixels in whose shares they lie.
  void add_bytes(std::vector<float>& pixels) const { surface_.add_bytes(pixels); }

 private:
  const ZOrder& order_;
  std::uint32_t share_;  // chunks
  TileSurface surface_;
};

}  // namespace beampipe
