// compose_window (stage `compose` of beam): one window of fragments per pixel -> the pixels' area-conserving
// aggregates.
//
// Within a window (stages/beam/windows.h), depth is compared position by position (simd/window_owners.h), so fragments
// that interpenetrate need no order. Then each visible fragment adds its area (simd/conserve.h) to the aggregate. The
// aggregate, a mask, an area and a colour, is all that is kept from one window to the next.
#pragma once

#include <cstdint>
#include <cstring>
#include <vector>

#include "stages/cost/counters.h"
#include "stages/data/beam_aggregate.h"
#include "stages/data/fragment.h"
#include "stages/data/pair.h"
#include "stages/data/pixel_formats.h"
#include "stages/data/pixel_observer.h"
#include "stages/data/position_set.h"
#include "stages/data/tile.h"
#include "stages/surface/surface_shader.h"

namespace beampipe {

// Adds `fragments` to `pixels`, of which there is one per pixel of the tile; at first they are empty (zeros). There is
// at most one window per pixel: its fragments follow each other, in primitive order. Sets areas[i] to the area that
// fragments[i] adds to its pixel.
template <std::size_t Words>
void compose_window(const std::vector<Fragment>& fragments, const PositionSet& positions, StageCounters& counters,
                    std::vector<StoredAggregate<Words>>& pixels, std::vector<float>& areas,
                    const PixelObservers* observers = nullptr);

// Pixels that a single triangle covers completely and hides.
struct WholePixels {
  const std::vector<Pair>& pairs;
  const Tile& tile;
  const TileShader& shader;
  TexelRequests* texels = nullptr;  // that shading reads: a request for each pair; null: they are not kept
};

// Composes such pixels, which must be empty. The result is that of compose_window for the triangle's fragment, which is
// not needed here.
template <std::size_t Words>
void compose_whole(const WholePixels& whole, StageCounters& counters, std::vector<StoredAggregate<Words>>& pixels,
                   const PixelObservers* observers = nullptr);

// Are all positions of the pixel taken, so that nothing farther can be visible in it?
template <std::size_t Words>
bool is_closed(const StoredAggregate<Words>& pixel) {
  std::uint32_t mask[Words], all = ~0u;  // a copy, because the words of a packed pixel may not be aligned
  std::memcpy(mask, pixel.mask, sizeof mask);
  for (const std::uint32_t word : mask) all &= word;
  return all == ~0u;
}

template <std::size_t Words>
std::vector<PixelColor> composed_colors(const std::vector<StoredAggregate<Words>>& pixels) {
  std::vector<PixelColor> colors;
  colors.reserve(pixels.size());
  for (const auto& pixel : pixels) colors.push_back({pixel.area, {pixel.color[0], pixel.color[1], pixel.color[2]}});
  return colors;
}

// Per pixel: is it closed?
template <std::size_t Words>
std::vector<bool> closed_pixels(const std::vector<StoredAggregate<Words>>& pixels) {
  std::vector<bool> closed;
  closed.reserve(pixels.size());
  for (const auto& pixel : pixels) closed.push_back(is_closed(pixel));
  return closed;
}

// Per pixel: does anything cover it?
template <std::size_t Words>
std::vector<bool> covered_pixels(const std::vector<StoredAggregate<Words>>& pixels) {
  std::vector<bool> covered;
  covered.reserve(pixels.size());
  for (const auto& pixel : pixels) covered.push_back(pixel.area > 0);
  return covered;
}

}  // namespace beampipe
