// Memory traffic of one bin's A-buffer: insertion, sorting, reading in order.
#pragma once

#include <vector>

#include "pipeline/memory/linear_memory.h"
#include "pipeline/memory/tile_surface.h"
#include "stages/beam/a_buffer.h"

namespace beampipe {

class ABufferMemory {
 public:
  ABufferMemory(const MemorySystem& memory, const ZOrder& order, std::size_t records, std::uint32_t record_bytes);

  // The pass that fills it: each record exchanges its pixel's head link, and is written after the previous record.
  void insert(const std::vector<SortRecord>& records, StageCounters& counters);

  // The pass that empties it, pixel by pixel: every record is read to be sorted; then the first `read` ones are read
  // again in order.
  void read_to_sort(std::uint32_t pixel, const ABuffer& buffer, StageCounters& counters);
  void read_in_order(std::uint32_t pixel, const ABuffer& buffer, std::uint32_t read, StageCounters& counters);
  void finish(StageCounters& counters) { records_.flush(counters); }

  // Logical bytes of a pixel with so many records, of which `read` were read in order: filling, heads and records read
  // to be sorted, records read in order.
  float bytes_of(std::uint32_t records, std::uint32_t read) const {
    return static_cast<float>(records * (2 * kLinkBytes + record_bytes_) + kLinkBytes + records * record_bytes_ +
                              read * record_bytes_);
  }

 private:
  void read_record(std::uint32_t pixel, std::uint32_t record, StageCounters& counters) {
    records_.read(pixel, std::size_t{record} * record_bytes_, record_bytes_, counters);
  }

  std::uint32_t record_bytes_;  // with the link
  TileSurface heads_;           // exchanged by atomic operations, which L2 performs
  LinearMemory records_;
};

// Calls visit(pixel) for the tile's pixels that have records, in Z order.
template <class Visit>
void for_each_list(const ZOrder& order, const Tile& tile, const ABuffer& buffer, Visit&& visit) {
  std::vector<std::uint32_t> pixel_at(order.positions, ~0u);
  for (std::uint32_t pixel = 0; pixel < tile.pixels(); ++pixel) pixel_at[order.of[pixel]] = pixel;
  for (const std::uint32_t pixel : pixel_at)
    if (pixel != ~0u && buffer.record_count(pixel) > 0) visit(pixel);
}

}  // namespace beampipe
