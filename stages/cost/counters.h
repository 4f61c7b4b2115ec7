// What a stage did in one frame, in items, operations, bytes and lanes.
#pragma once

#include <cstdint>
#include <string>

namespace beampipe {

#ifdef BEAMPIPE_COUNT_NOTHING
// Drops what is added to it: a program without counters, to measure what they cost.
struct Count {
  constexpr Count(std::uint64_t = 0) {}
  constexpr operator std::uint64_t() const { return 0; }
  constexpr Count& operator+=(std::uint64_t) { return *this; }
  constexpr Count& operator*=(std::uint64_t) { return *this; }
  constexpr Count& operator++() { return *this; }
};
#else
using Count = std::uint64_t;
#endif

// Scalar operations by kind, as the stage's scalar twin does them.
struct OperationCounts {
  Count mul_add = 0;  // multiplications; an addition behind one is an add
  Count add = 0;      // additions, subtractions, comparisons, minima, maxima, selects
  Count bit = 0;      // and, or, not, shift, population count
  Count fetch = 0;    // table look-ups
  Count special = 0;  // divisions, square roots
  Count convert = 0;  // integer <-> float, float <-> half

  Count total() const { return mul_add + add + bit + fetch + special + convert; }

  OperationCounts& operator+=(const OperationCounts& other) {
    mul_add += other.mul_add;
    add += other.add;
    bit += other.bit;
    fetch += other.fetch;
    special += other.special;
    convert += other.convert;
    return *this;
  }
  friend OperationCounts operator*(OperationCounts counts, std::uint64_t times) {
    counts.mul_add *= times;
    counts.add *= times;
    counts.bit *= times;
    counts.fetch *= times;
    counts.special *= times;
    counts.convert *= times;
    return counts;
  }
  bool operator==(const OperationCounts&) const = default;
};

struct StageCounters {
  std::string stage;  // the design's stage name, for instance "conservative_raster"
  Count items_in = 0;
  Count items_out = 0;
  OperationCounts ops{};
  Count bytes_read = 0;     // logical: what the algorithm touches
  Count bytes_written = 0;  // logical
  Count lanes_used = 0;     // lanes with work; for `shade` the fragments
  Count lanes_issued = 0;   // lanes that ran; for `shade` with the helpers of 2x2 quads
  Count sector_bytes = 0;   // asked of the memory system, read and written, in whole sectors
  Count l2_bytes = 0;       // of that, what the caches before L2 do not hold, and what they evict
  Count dram_bytes = 0;     // moved to and from DRAM behind the modelled caches, read and written
  // Of the stages that rasterize:
  Count hidden_items = 0;      // pairs (or cells) left out behind what closes their pixel (or cell)
  Count hidden_triangles = 0;  // left out behind what closes all of a tile, once for each tile
  Count empty_tiles = 0;       // tiles without a triangle

  Count logical_bytes() const { return bytes_read + bytes_written; }

  StageCounters& operator+=(const StageCounters& other) {
    items_in += other.items_in;
    items_out += other.items_out;
    ops += other.ops;
    bytes_read += other.bytes_read;
    bytes_written += other.bytes_written;
    lanes_used += other.lanes_used;
    lanes_issued += other.lanes_issued;
    sector_bytes += other.sector_bytes;
    l2_bytes += other.l2_bytes;
    dram_bytes += other.dram_bytes;
    hidden_items += other.hidden_items;
    hidden_triangles += other.hidden_triangles;
    empty_tiles += other.empty_tiles;
    return *this;
  }
  bool operator==(const StageCounters&) const = default;
};

}  // namespace beampipe
