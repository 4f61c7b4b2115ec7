// The aggregates of one bin in memory, one surface per member of the framebuffer.
#pragma once

#include <vector>

#include "pipeline/memory/framebuffer.h"
#include "pipeline/memory/tile_surface.h"

namespace beampipe {

class AggregateMemory {
 public:
  // `order` must outlive it.
  AggregateMemory(const MemorySystem& memory, const ZOrder& order, const std::vector<Surface>& framebuffer);

  // Merging a fragment in place, as composition in primitive order does: the aggregate is read and written.
  void merge(std::uint32_t triangle, std::uint32_t pixel, StageCounters& counters);

  // Reading it alone.
  void read(std::uint32_t pixel, StageCounters& counters);

  // Writing an aggregate that was composed on chip.
  void write(std::uint32_t pixel, StageCounters& counters);

  // The end of a pass: everything goes back to memory. `full`, one per pixel or empty, says which pixels nothing shows
  // through: a block of coverages or masks that are all full is stored as one of them.
  void flush(const std::vector<bool>& full, StageCounters& counters);

  void read_all(StageCounters& counters);

  // Adds the logical bytes that merging and writing have moved, pixel by pixel.
  void add_bytes(std::vector<float>& pixels) const;

  AggregateMemory(const AggregateMemory&) = delete;
  AggregateMemory& operator=(const AggregateMemory&) = delete;

 private:
  const ZOrder& order_;
  std::vector<bool> full_;  // by position in Z order
  std::vector<TileSurface> surfaces_;
};

}  // namespace beampipe
