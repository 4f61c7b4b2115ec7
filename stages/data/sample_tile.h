// The multisampled surface of a tile: a depth and a triangle for each sample.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "simd/depth_compare.h"
#include "stages/data/pixel_observer.h"
#include "stages/data/sample_fragment.h"

namespace beampipe {

inline constexpr std::uint32_t kNoTriangle = ~0u;  // the background
inline constexpr float kFarDepth = 1.0f;           // beyond every depth: the cleared surface

// Sizes in the modelled machine, per sample.
inline constexpr std::uint32_t kSampleDepthBytes = 4;  // 32-bit depth
inline constexpr std::uint32_t kSampleColorBytes = 6;  // fp16 RGB

// Samples are ordered by pixel (row by row), by cell within the pixel and by sample within the cell. Instead of its
// colour, a sample keeps the index of its triangle, which has one colour. In the modelled machine a sample has
// kSampleDepthBytes of depth and `color_bytes` of colour or of a visibility id: 0 while only depth is written.
struct SampleTile {
  std::vector<float> depth;
  std::vector<std::uint32_t> triangle;
  // What was blended over the triangle: linear RGB, times alpha, and alpha. Empty if nothing is translucent.
  std::vector<glm::vec4> over;
  std::size_t samples_per_pixel = 0;
  std::uint32_t color_bytes = kSampleColorBytes;
  // Who looks at the pixels; null: nobody. There the first sample has this number.
  const PixelObservers* observers = nullptr;
  std::size_t first_observed = 0;

  SampleTile(const Tile& tile, const Sampling& sampling, std::uint32_t color_bytes_per_sample = kSampleColorBytes);
};

// Do `count` samples all show this triangle? Compares many at once, without branches.
inline bool all_show(const std::uint32_t* owners, std::size_t count, std::uint32_t triangle) {
  std::uint32_t differences = 0;
  for (std::size_t i = 0; i < count; ++i) differences |= owners[i] ^ triangle;
  return differences == 0;
}

}  // namespace beampipe
