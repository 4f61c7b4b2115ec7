// Memory traffic of geometry. The frame is binned as a whole: vertex_setup writes setup triangles and their attributes
// as two arrays in primitive order, and each bin reads those of its list.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "pipeline/memory/linear_memory.h"
#include "stages/cost/counters.h"
#include "stages/data/setup_triangle.h"
#include "stages/data/tile.h"

namespace beampipe {

// One run of vertex_setup: it reads `vertex_bytes` of vertices and indices once, and writes so many triangles.
void move_setup(const MemoryParameters& memory, std::uint64_t vertex_bytes, std::size_t triangles,
                StageCounters& counters);

// Binning writes a bin's list, 4 bytes per triangle.
void write_list(const MemoryParameters& memory, const TriangleList& list, StageCounters& counters);

// One pass of the raster stage over a bin reads the list.
void read_list(const MemoryParameters& memory, const TriangleList& list, StageCounters& counters);

// The same, and the setup of the list's triangles in primitive order.
void read_bin(const MemoryParameters& memory, const TriangleList& list, StageCounters& counters);

// Attributes read in primitive order, as forward shading does in one pass over a bin: each triangle's are read once.
class AttributesInOrder {
 public:
  explicit AttributesInOrder(const MemoryParameters& memory) : records_(memory, sizeof(FlatAttributes)) {}

  template <class Fragment>
  void read(const std::vector<Fragment>& fragments, StageCounters& counters) {
    for (const Fragment& fragment : fragments) records_.read(fragment.triangle, counters);
  }

 private:
  RecordsInOrder records_;
};

// Setup and attributes that shaders fetch by triangle number, through the L1 of the multiprocessor that works on the
// bin. Each fetch is a request of its own.
class TriangleFetches {
 public:
  // `list` must outlive it.
  TriangleFetches(const MemoryParameters& memory, const TriangleList& list);
  TriangleFetches(const MemoryParameters& memory, TriangleList&& list) = delete;

  void setup(std::uint32_t triangle, StageCounters& counters) {
    if (modelled_) lines_.read(++request_, places_.setup[rank(triangle)], sizeof(SetupTriangle), counters);
  }
  void attributes(std::uint32_t triangle, StageCounters& counters) {
    if (modelled_) lines_.read(++request_, places_.attributes[rank(triangle)], sizeof(FlatAttributes), counters);
  }

  // The depth plane alone.
  void depth(std::uint32_t triangle, StageCounters& counters) {
    constexpr std::size_t kBegin = offsetof(SetupTriangle, depth);
    if (modelled_) lines_.read(++request_, places_.setup[rank(triangle)] + kBegin, sizeof(ScreenDepth), counters);
  }

  // For the triangles of all pairs or fragments.
  template <class Item>
  void setup(const std::vector<Item>& items, StageCounters& counters) {
    for (const Item& item : items) setup(item.triangle, counters);
  }
  template <class Item>
  void attributes(const std::vector<Item>& items, StageCounters& counters) {
    for (const Item& item : items) attributes(item.triangle, counters);
  }

  // The raster stage of this pass has just read the setup of the bin's triangles, so L2 holds it. Charges nothing.
  void load_setup();

  // The raster stage reads the setup of the bin's triangles through L2, in the order of this list. Neighbours in the
  // list are not neighbours in memory, so L2 is asked for more sectors than in primitive order.
  void read_setup(const TriangleList& sorted, StageCounters& counters);

  // The end of a pass over the frame.
  void flush(StageCounters& counters) { lines_.flush(counters); }

 private:
  std::size_t rank(std::uint32_t triangle) const;

  // Where the records of the list's triangles lie, in a memory of only those lines that hold a record of the bin.
  struct Places {
    std::vector<std::uint32_t> setup, attributes;
    std::uint32_t end = 0;  // of that memory, in bytes
  };
  static Places places_of(const TriangleList& list, std::uint32_t line_bytes);

  bool modelled_;
  const TriangleList& list_;
  Places places_;
  LinearMemory lines_;
  std::uint32_t request_ = 0;
};

}  // namespace beampipe
