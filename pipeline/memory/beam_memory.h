// What the beam pipeline moves for one bin: the A-buffer, which is kept in memory from one pass over the frame to the
// next, and the aggregates.
#pragma once

#include <vector>

#include "pipeline/memory/linear_memory.h"
#include "pipeline/memory/tile_surface.h"
#include "pipeline/technique.h"
#include "stages/beam/a_buffer.h"
#include "stages/picture/resolve.h"

namespace beampipe {

class ABufferMemory {
 public:
  ABufferMemory(const MemoryParameters& parameters, const ZOrder& order, std::size_t records,
                std::uint32_t record_bytes);

  // The pass that fills it: each record exchanges its pixel's head link, and goes behind the one before.
  void insert(const std::vector<SortRecord>& records, StageCounters& counters);

  // The pass that empties it, pixel by pixel: all records to be sorted, then again the first `merged` in order.
  void sort(std::uint32_t pixel, const ABuffer& buffer, StageCounters& counters);
  void compose(std::uint32_t pixel, const ABuffer& buffer, std::uint32_t merged, StageCounters& counters);
  void finish(StageCounters& counters) { records_.flush(counters); }

  // Logical bytes of a pixel with so many records, of which `merged` were looked at: filling, heads and records read to
  // be sorted, records read in order.
  float bytes_of(std::uint32_t records, std::uint32_t merged) const {
    return static_cast<float>(records * (2 * kLinkBytes + record_bytes_) + kLinkBytes + records * record_bytes_ +
                              merged * record_bytes_);
  }

 private:
  void read_record(std::uint32_t pixel, std::uint32_t record, StageCounters& counters) {
    records_.read(pixel, std::size_t{record} * record_bytes_, record_bytes_, counters);
  }

  std::uint32_t record_bytes_;  // with the link
  TileSurface heads_;           // exchanged by atomic operations, which L2 does
  LinearMemory records_;
};

// The aggregates of a bin, one surface per member.
class AggregateMemory {
 public:
  AggregateMemory(const MemoryParameters& parameters, const ZOrder& order, const std::vector<Surface>& framebuffer);

  // Merging a fragment in place, as a streaming composition does: the aggregate is read and written.
  void merge(std::uint32_t triangle, std::uint32_t pixel, StageCounters& counters);

  // Writing an aggregate that was composed on chip.
  void write(std::uint32_t pixel, StageCounters& counters);

  // What is stored at the end of a pass. A block of coverages or masks that are all those of a full pixel is stored as
  // one of them; `full`, one per pixel, says which are.
  void flush(const std::vector<bool>& full, StageCounters& counters);

  void read_all(StageCounters& counters);

  // Adds the logical bytes that merging and writing have moved, pixel by pixel.
  void add_bytes(std::vector<float>& pixels) const;

 private:
  const ZOrder& order_;
  std::vector<bool> full_;  // by position in Z order
  std::vector<TileSurface> surfaces_;
};

// All of it, for aggregates that are composed from a sorted A-buffer. Per pixel, `merged`: the records that were looked
// at; `written`: was an aggregate stored? `full`: nothing shows through it. `fetching`: the stage that reads sorted
// records. Returns the logical bytes of each pixel.
std::vector<float> count_sorted_composition(const MemoryParameters& parameters, const Tile& tile, const ABuffer& buffer,
                                            const std::vector<SortRecord>& records, std::uint32_t record_bytes,
                                            const std::vector<float>& merged, const std::vector<bool>& written,
                                            const std::vector<bool>& full, const std::vector<Surface>& framebuffer,
                                            StageCounters& buffering, StageCounters& fetching,
                                            StageCounters& composition, StageCounters& resolving);

}  // namespace beampipe
