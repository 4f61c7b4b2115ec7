// The multisampled surfaces of one bin in memory: depth, and beside it colour or visibility ids.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "pipeline/memory/tile_surface.h"
#include "stages/data/ordered_tile.h"
#include "stages/samples/test_depth.h"

namespace beampipe {

class SampleMemory {
 public:
  // Tells whether two triangles write the same value into the second surface.
  using SameValue = std::function<bool(std::uint32_t triangle, std::uint32_t other)>;

  // `color_bytes`: of a sample of the second surface; 0 when there is only depth.
  SampleMemory(const MemorySystem& memory, const Tile& tile, const Sampling& sampling, std::uint32_t color_bytes,
               SameValue same_value = std::equal_to<std::uint32_t>());

  // Every test reads depth. Samples that pass write both surfaces (test_and_write), depth (test_depth) or the second
  // surface (test_equal).
  void test_and_write(const std::vector<SampleAccess>& accesses, StageCounters& counters) {
    replay(accesses, true, true, counters);
  }
  void test_depth(const std::vector<SampleAccess>& accesses, StageCounters& counters) {
    replay(accesses, true, false, counters);
  }
  void test_equal(const std::vector<SampleAccess>& accesses, StageCounters& counters) {
    replay(accesses, false, true, counters);
  }

  // Reads depth alone.
  void test(const std::vector<SampleAccess>& accesses, StageCounters& counters);

  // Reads the colours of samples that pass, and writes them again.
  void blend(const std::vector<SampleAccess>& accesses, StageCounters& counters);

  // In the API's order: depths that are read and written, and colours.
  void test_in_order(const std::vector<OrderedAccess>& accesses, StageCounters& counters);
  void blend_in_order(const std::vector<OrderedAccess>& accesses, StageCounters& counters);

  SampleMemory(const SampleMemory&) = delete;
  SampleMemory& operator=(const SampleMemory&) = delete;

  // The end of a pass over the frame.
  void flush(StageCounters& counters);

  // Passes of other stages that read every sample of a surface.
  void read_depth(StageCounters& counters) { depth_.read_all(counters); }
  void read_color(StageCounters& counters) { color_->read_all(counters); }

  // Adds the logical bytes that tests and writes have moved, pixel by pixel.
  void add_bytes(std::vector<float>& pixels) const;

 private:
  void replay(const std::vector<SampleAccess>& accesses, bool write_depth, bool write_color, StageCounters& counters);
  bool covers_cell(std::uint32_t samples) const { return samples == (std::uint64_t{1} << samples_) - 1; }
  void own(std::size_t first, std::uint32_t samples, std::uint32_t triangle, std::vector<std::uint32_t>& owner) const;
  std::uint32_t depth_bytes(std::size_t first, std::size_t elements);
  std::uint32_t color_bytes(std::size_t first, std::size_t elements) const;

  bool modelled_;
  std::uint32_t plane_bytes_;
  std::size_t samples_;  // per cell
  std::size_t cells_;    // per pixel
  ZOrder order_;
  std::vector<std::uint32_t> cell_position_;  // of each cell in the Z order
  SameValue same_value_;
  std::uint32_t color_sample_bytes_;
  std::vector<std::uint32_t> owner_;        // triangle of each sample that this pass has written, in Z order
  std::vector<std::uint32_t> color_owner_;  // of its colour, where draws keep the API's order; else empty
  std::vector<std::uint32_t> planes_;       // of the block that is compressed; kept so that it is allocated once
  TileSurface depth_;
  std::optional<TileSurface> color_;
};

}  // namespace beampipe
