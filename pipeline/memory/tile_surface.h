// One surface of a bin in memory, seen through a cache. Its elements are pixels, or cells of super-resolved pixels;
// blocks of them follow a Z-order curve.
#pragma once

#include <bit>
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

  // What an element is: at most 16 parts, together at most 256 bytes.
  struct Element {
    std::uint32_t parts = 1;
    std::uint32_t part_bytes = 0;           // of each
    CompressedBytes compressed_bytes = {};  // empty: nothing compresses
  };

  // A block has as many elements, a power of two, as fit into a line of the cache. The surface starts out cleared.
  // `order` must outlive it. `name`: of the array that all bins' surfaces of this name are parts of.
  TileSurface(const MemorySystem& memory, std::string_view name, const ZOrder& order, const Element& element,
              BlockCache::Level level = BlockCache::Level::rop);

  // Reads and writes parts of an element; bit p of a mask is part p. `key`: the triangle, as in BlockCache.
  void access(std::uint32_t key, std::uint32_t element, std::uint32_t read, std::uint32_t write,
              StageCounters& counters) {
    access_at(key, order_.of[element], read, write, counters);
  }

  // The same for the element at a position of the Z order.
  void access_at(std::uint32_t key, std::uint32_t position, std::uint32_t read, std::uint32_t write,
                 StageCounters& counters) {
    access_run(
        1,
        [&](std::size_t) {
          return Access{key, position, read, write};
        },
        counters);
  }

  // An element's key, its position in the Z order, and the parts to read and write.
  struct Access {
    std::uint32_t key, position, read, write;
  };

  // Of `count` accesses, at(0), at(1), ..., at least one: those at the front that have one key and lie in one block,
  // which are one request. Returns how many these are.
  template <class At>
  std::size_t access_run(std::size_t count, At&& at, StageCounters& counters) {
    if (touched_parts_.empty()) return count;  // there are no accesses to model
    Access access = at(0);
    const std::uint32_t key = access.key, block = access.position >> log2_elements_per_block_;
    const std::uint32_t first_position = block << log2_elements_per_block_;
    Sectors read = 0, write = 0;
    std::size_t run = 0;
    do {
      const std::uint32_t place = access.position - first_position;
      const Parts reads = parts_of(place, access.read), writes = parts_of(place, access.write);
      touched_parts_[access.position] += std::uint32_t{reads.count} + writes.count;
      read |= reads.sectors, write |= writes.sectors;
      if (++run == count) break;
      access = at(run);
    } while (access.key == key && access.position >> log2_elements_per_block_ == block);
    cache_.access(key, block, read, write, counters, [&](auto&& count_bytes) {
      for (std::size_t i = 0; i < run; ++i) {
        const Access written = at(i);
        const std::uint32_t begin = (written.position - first_position) * element_bytes_;
        for (std::uint32_t left = written.write; left != 0; left &= left - 1)
          count_bytes(begin + static_cast<std::uint32_t>(std::countr_zero(left)) * part_bytes_, part_bytes_);
      }
    });
    return run;
  }

  // The same for elements of a single part.
  void read(std::uint32_t key, std::uint32_t element, StageCounters& counters) { access(key, element, 1, 0, counters); }
  void write(std::uint32_t key, std::uint32_t element, StageCounters& counters) {
    access(key, element, 0, 1, counters);
  }

  // The end of a pass over the frame: everything goes back to memory.
  void flush(StageCounters& counters) { cache_.flush(counters); }

  // A pass that reads every element of the bin once.
  void read_all(StageCounters& counters);

  // Logical bytes that were read and written at a position of the Z order.
  std::uint32_t touched_bytes(std::uint32_t position) const {
    return touched_parts_.empty() ? 0 : touched_parts_[position] * part_bytes_;
  }

  // Adds them to values of pixels, where elements are pixels.
  void add_bytes(std::vector<float>& pixels) const {
    for (std::size_t i = 0; i < pixels.size(); ++i) pixels[i] += static_cast<float>(touched_bytes(order_.of[i]));
  }

 private:
  // How many parts of an element, and the sectors that they lie in.
  struct Parts {
    Sectors sectors = 0;
    std::uint8_t count = 0;

    Parts operator+(const Parts& others) const {
      return {static_cast<Sectors>(sectors | others.sectors), static_cast<std::uint8_t>(count + others.count)};
    }
  };

  // Of the n-th element of a block. The table is looked up by bytes of the mask of parts.
  Parts parts_of(std::uint32_t n, std::uint32_t mask) const {
    const Parts* const table = &part_table_[n * mask_bytes_ << kMaskBits];
    return mask_bytes_ == 1 ? table[mask] : table[mask & 0xff] + table[1 << kMaskBits | mask >> kMaskBits];
  }

  // Indexed by element of a block, byte of the mask of parts, and value of that byte.
  static std::vector<Parts> part_table(std::uint32_t elements, std::uint32_t parts, std::uint32_t part_bytes,
                                       int log2_sector);

  static constexpr std::uint32_t kMaskBits = 8;  // that a table is looked up by

  const ZOrder& order_;
  std::uint32_t part_bytes_, element_bytes_, mask_bytes_;
  int log2_elements_per_block_;
  std::vector<Parts> part_table_;
  std::vector<std::uint32_t> touched_parts_;  // by position: how many were read and written; empty if not modelled
  BlockCache cache_;
};

}  // namespace beampipe
