// What accumulation moves for one bin, pixel by pixel: the accumulators, and the stencil values of a round's samples.
#pragma once

#include <algorithm>
#include <vector>

#include "pipeline/memory/tile_surface.h"
#include "simd/depth_compare.h"
#include "stages/samples/test_depth.h"

namespace beampipe {

inline std::uint32_t pixel_of(const SampleFragment& fragment, const Tile& tile) {
  return static_cast<std::uint32_t>(tile.index(fragment.x, fragment.y));
}

class AccumulatorMemory : public TileSurface {
 public:
  using TileSurface::TileSurface;

  // Adding to a pixel's accumulator reads and writes it.
  void blend(const std::vector<SampleFragment>& fragments, const Tile& tile, StageCounters& counters) {
    for (const SampleFragment& fragment : fragments) blend(fragment.triangle, pixel_of(fragment, tile), counters);
  }

  // The background is blended in wherever a sample is clear.
  void blend_background(const SampleTile& depth, StageCounters& counters) {
    const auto samples = static_cast<std::ptrdiff_t>(depth.samples_per_pixel);
    const auto pixels = static_cast<std::uint32_t>((depth.depth.size() - kSampleSlack) / depth.samples_per_pixel);
    for (std::uint32_t pixel = 0; pixel < pixels; ++pixel) {
      const auto first = depth.depth.begin() + pixel * samples;
      if (std::find(first, first + samples, kFarDepth) != first + samples) blend(kNoTriangle, pixel, counters);
    }
  }

 private:
  void blend(std::uint32_t triangle, std::uint32_t pixel, StageCounters& counters) {
    read(triangle, pixel, counters);
    write(triangle, pixel, counters);
  }
};

class StencilMemory : public TileSurface {
 public:
  StencilMemory(const MemoryParameters& parameters, const ZOrder& order, const Sampling& sampling)
      : TileSurface(parameters, order, static_cast<std::uint32_t>(sampling.pattern.count), 1) {}

  // Reads the values of the fragments' samples; writes those of the samples that they are left with.
  void test(const std::vector<SampleFragment>& fragments, const Tile& tile, StageCounters& counters) {
    for (const SampleFragment& fragment : fragments)
      access(fragment.triangle, pixel_of(fragment, tile), fragment.mask, 0, counters);
  }
  void mark(const std::vector<SampleFragment>& fragments, const Tile& tile, StageCounters& counters) {
    for (const SampleFragment& fragment : fragments)
      access(fragment.triangle, pixel_of(fragment, tile), 0, fragment.mask, counters);
  }
};

}  // namespace beampipe
