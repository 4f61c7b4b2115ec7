// Memory traffic of geometry. The frame is binned as a whole: vertex_setup writes setup triangles and their attributes
// as two arrays in primitive order, and each bin reads those of its list. Triangles that are not flat have, instead of
// flat attributes, planes and three vertices: two more arrays. Without bins all this stays on chip, and only vertices
// and indices are read.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "pipeline/memory/linear_memory.h"
#include "stages/cost/counters.h"
#include "stages/data/setup_triangle.h"
#include "stages/data/tile.h"
#include "stages/surface/surface_shader.h"

namespace beampipe {

// Arrays of the frame.
inline constexpr const char* kSetupArray = "setup_triangles";
inline constexpr const char* kAttributesArray = "attributes";

// The memory system, which models nothing if triangles stay on chip.
inline MemorySystem of_triangles(MemorySystem memory) {
  memory.modelled = memory.stores_triangles();
  return memory;
}

// One run of vertex_setup: it reads `vertex_bytes` of vertices and indices once, and writes so many triangles and
// `surface_bytes` of what triangles with materials have besides.
void move_setup(const MemorySystem& memory, std::uint64_t vertex_bytes, std::size_t triangles,
                std::uint64_t surface_bytes, StageCounters& counters);

// Binning writes a bin's list, 4 bytes per triangle.
void write_list(const MemorySystem& memory, const TriangleList& list, StageCounters& counters);

// One pass of the raster stage over a bin reads the list.
void read_list(const MemorySystem& memory, const TriangleList& list, StageCounters& counters);

// The same, and the setup of the list's triangles in primitive order.
void read_bin(const MemorySystem& memory, const TriangleList& list, StageCounters& counters);

// Where each triangle stands in a list. A hash table, because fetches ask for it once each.
class ListRanks {
 public:
  // The list has no triangle twice.
  explicit ListRanks(const TriangleList& list);

  // The triangle is in the list.
  std::uint32_t of(std::uint32_t triangle) const {
    std::size_t place = hash(triangle);
    while (entries_[place].triangle != triangle) place = (place + 1) & (entries_.size() - 1);
    return entries_[place].rank;
  }

 private:
  struct Entry {
    std::uint32_t triangle = ~0u, rank = ~0u;  // ~0: no triangle
  };
  std::size_t hash(std::uint32_t triangle) const { return triangle * 0x9e3779b1u >> shift_; }

  std::vector<Entry> entries_;  // a power of two, of which at most half are used
  int shift_;
};

// Setup and attributes that shaders fetch by triangle number, through the L1 of the multiprocessor that works on the
// bin. Each fetch is a request of its own.
class TriangleFetches {
 public:
  // The shader must outlive it. Without a shader all triangles are flat.
  TriangleFetches(const MemorySystem& memory, const TriangleList& list, const SurfaceShader* shader = nullptr);

  bool is_flat(std::uint32_t triangle) const { return !shader_ || shader_->is_flat(triangle); }

  // `times` fetches, one after the other.
  void setup(std::uint32_t triangle, StageCounters& counters, std::uint64_t times = 1) {
    if (modelled_) lines_.fetch(places_.setup[rank(triangle)], sizeof(SetupTriangle), times, counters);
  }
  void attributes(std::uint32_t triangle, StageCounters& counters, std::uint64_t times = 1) {
    if (!modelled_) return;
    if (is_flat(triangle)) {
      lines_.fetch(places_.attributes[rank(triangle)], sizeof(FlatAttributes), times, counters);
    } else {
      for (std::uint64_t i = 0; i < times; ++i) surface(triangle, counters);
    }
  }

  // The depth plane alone, or with the depths of the vertices, which stand before it.
  void depth(std::uint32_t triangle, StageCounters& counters, bool has_vertices = false) {
    constexpr std::size_t kEnd = offsetof(SetupTriangle, depth) + sizeof(ScreenDepth);
    const std::size_t begin = has_vertices ? offsetof(SetupTriangle, vertex_z) : offsetof(SetupTriangle, depth);
    if (modelled_)
      lines_.fetch(places_.setup[rank(triangle)] + begin, static_cast<std::uint32_t>(kEnd - begin), 1, counters);
  }

  // For the triangles of all pairs or fragments.
  template <class Item>
  void setup(const std::vector<Item>& items, StageCounters& counters) {
    each_run(items, [&](std::uint32_t triangle, std::uint64_t times) { setup(triangle, counters, times); });
  }
  template <class Item>
  void attributes(const std::vector<Item>& items, StageCounters& counters) {
    each_run(items, [&](std::uint32_t triangle, std::uint64_t times) { attributes(triangle, counters, times); });
  }

  // The raster stage of this pass has just read the setup of the bin's triangles, so L2 holds it. Charges nothing.
  void load_setup();

  // The raster stage reads the setup of the bin's triangles through L2, in the order of this list. Neighbours in the
  // list are not neighbours in memory, so L2 is asked for more sectors than in primitive order.
  void read_setup(const TriangleList& sorted, StageCounters& counters);

  // The end of a pass over the frame.
  void flush(StageCounters& counters) { lines_.flush(counters); }

 private:
  std::size_t rank(std::uint32_t triangle) const { return ranks_.of(triangle); }

  // Calls fetch(triangle, times) for each run of items of one triangle.
  template <class Item, class Fetch>
  void each_run(const std::vector<Item>& items, Fetch&& fetch) const {
    if (!modelled_) return;
    for (std::size_t first = 0, end = 0; first < items.size(); first = end) {
      while (end < items.size() && items[end].triangle == items[first].triangle) ++end;
      fetch(items[first].triangle, end - first);
    }
  }

  // One fetch of the planes and vertices of a triangle that is not flat.
  void surface(std::uint32_t triangle, StageCounters& counters);

  // What the shader of a triangle that is not flat reads of each vertex.
  std::uint32_t vertex_bytes(std::uint32_t triangle) const {
    return static_cast<std::uint32_t>((shader_->work(triangle).input_bytes - kSurfaceBytes) / 3);
  }

  // Where the records of the list's triangles lie, in a memory of only those lines that hold a record of the bin.
  struct Places {
    std::vector<std::uint32_t> setup, attributes;
    std::vector<std::uint32_t> surfaces;                 // empty if all triangles are flat
    std::vector<std::uint32_t> vertices, vertex_places;  // in increasing order, and where they lie
    std::uint32_t end = 0;                               // of that memory, in bytes
    BlockPlaces lines;                                   // where each of its lines really lies
  };
  Places places_of(const MemorySystem& memory, const TriangleList& list) const;
  void place_surfaces(const TriangleList& list, std::uint32_t line_bytes, Places& places) const;

  // Adds the places of the triangles' or vertices' records in an array to `places` and to its lines.
  static void place_records(const TriangleList& list, std::string_view array, std::uint32_t record_bytes,
                            std::uint32_t line_bytes, std::vector<std::uint32_t>& offsets, Places& places);

  bool modelled_;
  const SurfaceShader* shader_;
  ListRanks ranks_;
  Places places_;
  LinearMemory lines_;
  std::uint32_t surface_fetches_ = 0;
};

// Attributes read in primitive order, as forward shading does in one pass over a bin: each triangle's are read once.
// The vertices of triangles that are not flat are in no order, so they are fetched.
class AttributesInOrder {
 public:
  // `fetches` must outlive it. Null: all triangles are flat.
  explicit AttributesInOrder(const MemorySystem& memory, TriangleFetches* fetches = nullptr)
      : records_(of_triangles(memory), kAttributesArray, sizeof(FlatAttributes)), fetches_(fetches) {}

  template <class Fragment>
  void read(const std::vector<Fragment>& fragments, StageCounters& counters) {
    std::uint32_t last = ~0u;  // triangle
    for (const Fragment& fragment : fragments) {
      if (fragment.triangle == last) continue;
      last = fragment.triangle;
      if (!fetches_ || fetches_->is_flat(last)) {
        records_.read(last, counters);
      } else if (last != fetched_) {
        fetches_->attributes(last, counters);
        fetched_ = last;
      }
    }
  }

 private:
  RecordsInOrder records_;
  TriangleFetches* fetches_;
  std::uint32_t fetched_ = ~0u;  // triangle
};

}  // namespace beampipe
