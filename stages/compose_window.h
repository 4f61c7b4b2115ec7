// compose_window: fragments sorted by their nearest depth -> one area-conserving aggregate per pixel.
//
// The list is cut into windows: runs of fragments whose depth ranges overlap. Windows lie strictly behind each other.
// Within a window depth is compared position by position (simd/depth_test.h), so interpenetrating fragments need no
// order; then each visible fragment adds its area (simd/conserve.h) to the aggregate, which is all that is kept from
// one window to the next: a mask, an area, a colour. The scratch of a window, a depth and an owner per position, exists
// once per pixel that is being composed, not per pixel of the frame. What lies behind a full mask is not looked at.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "stages/a_buffer.h"
#include "stages/resolve.h"
#include "stages/stored_aggregate.h"

namespace beampipe {

// Mask positions, and the three nearest of them to every place in the pixel.
struct PositionSet {
  static constexpr int kPlaces = 64;  // places per axis that are told apart
  std::vector<SamplePattern> patterns;
  std::vector<std::array<std::uint8_t, 3>> nearest;  // kPlaces x kPlaces, row by row

  explicit PositionSet(std::vector<SamplePattern> patterns);
  int count() const { return static_cast<int>(patterns.size()) * kMaxMaskSamples; }
  const std::array<std::uint8_t, 3>& nearest_to(float u, float v) const;  // u, v in 0..1
};

// Bytes of a fragment as it waits in the A-buffer: what the aggregate has, and the depth plane (3 x float32), the depth
// range (2 x float32), and the centroid with the facing (2 x 16 bits), for which the aggregate has no use.
constexpr std::uint32_t conserving_fragment_bytes(int positions) {
  return conserving_aggregate_bytes(positions, Storage::packed) + 12 + 8 + 4;
}

// Per pixel: the fragments of its largest window, and those that were looked at before its mask was full.
struct PixelWindows {
  std::vector<float> largest, merges;
};

// One pixel colour and coverage per pixel of the tile.
std::vector<PixelColor> compose_window(const std::vector<Fragment>& fragments, const ABuffer& buffer,
                                       const PositionSet& positions, Storage storage, StageCounters& counters,
                                       PixelWindows& windows);

}  // namespace beampipe
