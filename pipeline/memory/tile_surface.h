// One surface of a bin in memory, seen through a cache. Its elements are pixels, or cells of super-resolved pixels;
// blocks of them follow a Z-order curve.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "pipeline/memory/block_cache.h"

namespace beampipe {

// The Z order of a bin's elements. Element (x, y) is at position of[y * width + x]. Where width or height is not a
// power of two, some positions are unused.
struct ZOrder {
  std::vector<std::uint32_t> of;
  std::size_t positions = 0;  // one more than the largest position

  ZOrder(std::int32_t width, std::int32_t height);
};

class TileSurface {
 public:
  // Returns the compressed bytes of the block whose first element is at position `first`.
  using CompressedBytes = std::function<std::uint32_t(std::size_t first, std::size_t elements)>;

  // An element has `parts` (at most 16) of `part_bytes` each, together at most 256 bytes. A block has as many elements,
  // a power of two, as fit into a line of the cache. The surface starts out cleared. `order` must outlive it. `name`:
  // of the array that all bins' surfaces of this name are parts of.
  TileSurface(const MemorySystem& memory, std::string_view name, const ZOrder& order, std::uint32_t parts,
              std::uint32_t part_bytes, CompressedBytes compressed_bytes = nullptr,
              BlockCache::Level level = BlockCache::Level::rop);

  // Reads and writes parts of an element; bit p of a mask is part p. `key`: the triangle, as in BlockCache.
  void access(std::uint32_t key, std::uint32_t element, std::uint32_t read, std::uint32_t write,
              StageCounters& counters);

  // The same for elements of a single part.
  void read(std::uint32_t key, std::uint32_t element, StageCounters& counters) { access(key, element, 1, 0, counters); }
  void write(std::uint32_t key, std::uint32_t element, StageCounters& counters) {
    access(key, element, 0, 1, counters);
  }

  // The end of a pass over the frame: everything goes back to memory.
  void flush(StageCounters& counters) { cache_.flush(counters); }

  // A pass that reads every element of the bin once.
  void read_all(StageCounters& counters);

  // Logical bytes read and written, one value per element; empty if nothing is modelled.
  const std::vector<std::uint32_t>& touched_bytes() const { return touched_bytes_; }

  // Adds them to values of pixels, where elements are pixels.
  void add_bytes(std::vector<float>& pixels) const {
    for (std::size_t i = 0; i < touched_bytes_.size(); ++i) pixels[i] += static_cast<float>(touched_bytes_[i]);
  }

 private:
  // The sectors of some parts of the n-th element of a block. The table is looked up by bytes of the mask of parts.
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
