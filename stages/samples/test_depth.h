// depth_test: sample fragments -> the multisampled surface of the tile. LESS; equal depth: the earlier triangle stays.
#pragma once

#include <cstdint>
#include <vector>

#include "stages/cost/counters.h"
#include "stages/raster/sample_raster.h"

namespace beampipe {

inline constexpr std::uint32_t kNoTriangle = ~0u;  // the background
inline constexpr float kFarDepth = 1.0f;           // beyond every depth: the cleared surface

inline constexpr std::uint32_t kSampleDepthBytes = 4;
inline constexpr std::uint32_t kSampleColorBytes = 6;

// Samples in order of pixel (row by row), cell within the pixel, sample within the cell. A sample's colour is kept as
// the index of its triangle, which has one colour; the modelled surface is 32-bit depth and `color_bytes` of colour (or
// of a visibility id) per sample: 0 while only depth is written.
struct SampleTile {
  std::vector<float> depth;
  std::vector<std::uint32_t> triangle;
  std::size_t samples_per_pixel = 0;
  std::uint32_t color_bytes = kSampleColorBytes;

  SampleTile(const Tile& tile, const Sampling& sampling, std::uint32_t color_bytes_per_sample = kSampleColorBytes);
};

// What a fragment did to the samples of its cell, for the memory system. Bit s of a mask is sample s.
struct SampleAccess {
  std::uint32_t cell;      // of the tile: pixel (row by row) x cells per pixel + cell within the pixel
  std::uint32_t triangle;  // index into SetupTriangles
  std::uint32_t tested;    // samples whose depth was read
  std::uint32_t passed;
};

// `accesses`, one per fragment, replaces what was in it.
void depth_test(const SetupTriangles& triangles, const std::vector<SampleFragment>& fragments, const Tile& tile,
                const Sampling& sampling, StageCounters& counters, SampleTile& surface,
                std::vector<SampleAccess>& accesses);

// The pass behind a depth-only one: of each fragment the samples that have the stored depth, fragments without any
// dropped. Charged with writing their colours. Where two triangles have the same depth, both keep the sample.
void depth_test_equal(const SetupTriangles& triangles, const Tile& tile, const Sampling& sampling,
                      StageCounters& counters, const SampleTile& surface, std::vector<SampleFragment>& fragments,
                      std::vector<SampleAccess>& accesses);

}  // namespace beampipe
