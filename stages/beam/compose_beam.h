// compose_window: one window of fragments per pixel -> the pixels' area-conserving aggregates.
//
// Within a window (stages/beam/windows.h) depth is compared position by position (simd/window_owners.h), so
// interpenetrating fragments need no order; then each visible fragment adds its area (simd/conserve.h) to the
// aggregate, which is all that is kept from one window to the next: a mask, an area, a colour. The scratch of a window
// exists once per pixel that is being composed, not per pixel of the frame.
#pragma once

#include <cstdint>
#include <cstring>
#include <vector>

#include "stages/beam/beam_fragment.h"
#include "stages/data/beam_aggregate.h"
#include "stages/data/position_set.h"
#include "stages/picture/resolve.h"

namespace beampipe {

// Bytes of a pair as it waits in the A-buffer: the triangle's number and its depth range in the pixel (2 x float32).
inline constexpr std::uint32_t kWaitingPairBytes = 4 + 8;

// Bytes of a fragment on its way from beam_fragment: pixel, colour (3 x fp16), area, mask, depth plane (3 x float32),
// and the centroid with the facing (2 x 16 bits).
constexpr std::uint32_t conserving_fragment_bytes(int positions) {
  return 4 + conserving_aggregate_bytes(positions, Storage::packed) + 12 + 4;
}

// Adds `fragments`, at most one window of each pixel, pixel by pixel and each in primitive order, to `pixels`, one per
// pixel of the tile; empty (zeros) before the first. areas[i]: what fragments[i] added to its pixel's area.
template <std::size_t Words, class Channel>
void compose_window(const std::vector<Fragment>& fragments, const PositionSet& positions, StageCounters& counters,
                    std::vector<StoredAggregate<Words, Channel>>& pixels, std::vector<float>& areas);

// The short way for empty pixels of which one triangle covers all: what compose_window would make of its fragment.
template <std::size_t Words, class Channel>
void compose_whole(const std::vector<PixelTriangle>& whole, const Tile& tile, const std::vector<glm::vec3>& colors,
                   StageCounters& counters, std::vector<StoredAggregate<Words, Channel>>& pixels);

// Nothing more can be seen in the pixel.
template <std::size_t Words, class Channel>
bool is_closed(const StoredAggregate<Words, Channel>& pixel) {
  std::uint32_t mask[Words], all = ~0u;  // a pixel is packed: its words need not be where words should
  std::memcpy(mask, pixel.mask, sizeof mask);
  for (const std::uint32_t word : mask) all &= word;
  return all == ~0u;
}

template <std::size_t Words, class Channel>
std::vector<PixelColor> composed_colors(const std::vector<StoredAggregate<Words, Channel>>& pixels) {
  std::vector<PixelColor> colors;
  colors.reserve(pixels.size());
  for (const auto& pixel : pixels) colors.push_back({pixel.area, {pixel.color[0], pixel.color[1], pixel.color[2]}});
  return colors;
}

// Per pixel: is it closed, is anything in it?
template <std::size_t Words, class Channel>
std::vector<bool> closed_pixels(const std::vector<StoredAggregate<Words, Channel>>& pixels) {
  std::vector<bool> closed;
  closed.reserve(pixels.size());
  for (const auto& pixel : pixels) closed.push_back(is_closed(pixel));
  return closed;
}
template <std::size_t Words, class Channel>
std::vector<bool> covered_pixels(const std::vector<StoredAggregate<Words, Channel>>& pixels) {
  std::vector<bool> covered;
  covered.reserve(pixels.size());
  for (const auto& pixel : pixels) covered.push_back(pixel.area > 0);
  return covered;
}

// The shapes that there are: X(words, channel).
#define BEAMPIPE_STORED_AGGREGATES(X) \
  X(1, HalfBits) X(2, HalfBits) X(4, HalfBits) X(8, HalfBits) X(1, float) X(2, float) X(4, float) X(8, float)

}  // namespace beampipe
