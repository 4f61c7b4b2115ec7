// One surface of a bin in memory: elements (pixels, or the cells of super-resolved pixels) of a fixed size in blocks
// along a Z-order curve, behind a cache.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "pipeline/memory/block_cache.h"

namespace beampipe {

// Elements of a bin in Z order, whatever its width and height: element (x, y) of a row-by-row numbering is at position
// of[y * width + x]; where width or height is no power of two, positions between are left out.
struct ZOrder {
  std::vector<std::uint32_t> of;
  std::size_t positions = 0;  // one beyond the last

  ZOrder(std::int32_t width, std::int32_t height);
};

class TileSurface {
 public:
  // Compressed bytes of the block whose first element is at position `first`.
  using CompressedBytes = std::function<std::uint32_t(std::size_t first, std::size_t elements)>;

  // Elements of `parts` x `part_bytes` <= 256 bytes, at most 16 parts. A block has as many of them, a power of two, as
  // fit into a cache line: of a ROP cache, or of L2. Starts out cleared.
  TileSurface(const MemoryParameters& parameters, const ZOrder& order, std::uint32_t parts, std::uint32_t part_bytes,
              CompressedBytes compressed_bytes = nullptr, BlockCache::Level level = BlockCache::Level::rop);

  // Reads and writes parts of an element; bit p of a mask is part p. `key` as in BlockCache: the triangle.
  void access(std::uint32_t key, std::uint32_t element, std::uint32_t read, std::uint32_t write,
              StageCounters& counters);

  // The same for the whole of an element of one part.
  void read(std::uint32_t key, std::uint32_t element, StageCounters& counters) { access(key, element, 1, 0, counters); }
  void write(std::uint32_t key, std::uint32_t element, StageCounters& counters) {
    access(key, element, 0, 1, counters);
  }

  // The end of a pass over the frame: everything goes back to memory.
  void flush(StageCounters& counters) { cache_.flush(counters); }

  // A pass that reads every element of the bin once.
  void read_all(StageCounters& counters);

  // Logical bytes that were read and written of each element, one by one; empty where memory is not modelled.
  const std::vector<std::uint32_t>& touched_bytes() const { return touched_bytes_; }

  // Adds them, where elements are pixels.
  void add_bytes(std::vector<float>& pixels) const {
    for (std::size_t i = 0; i < touched_bytes_.size(); ++i) pixels[i] += static_cast<float>(touched_bytes_[i]);
  }

 private:
  // The sectors of parts of an element that is the n-th of its block, by the parts' mask, a byte of it at a time.
  Sectors sectors_of_parts(std::uint32_t n, std::uint32_t parts) const {
    const Sectors* const table = &part_sectors_[n * mask_bytes_ << kMaskBits];
    return mask_bytes_ == 1 ? table[parts] : table[parts & 0xff] | table[1 << kMaskBits | parts >> kMaskBits];
  }

  static constexpr int kMaskBits = 8;

  const ZOrder& order_;
  std::uint32_t part_bytes_, element_bytes_, mask_bytes_;
  int log2_elements_per_block_;
  std::vector<Sectors> part_sectors_;
  std::vector<std::uint32_t> touched_bytes_;
  BlockCache cache_;
};

}  // namespace beampipe
