// settle: the end of a pass in streaming order. The owners' areas go into the pixels' colours, their positions are
// settled, and those that were deferred are free for the next pass.
#pragma once

#include <algorithm>
#include <vector>

#include "stages/beam/beam_fragment.h"
#include "stages/data/owner_pixel.h"
#include "stages/picture/resolve.h"

namespace beampipe {

// What must be known again of the owners: one pair per pixel and layer that owns a position, pixel by pixel. Counts
// reading the pixels that have any, and writing the pairs.
template <std::size_t Words, std::size_t Layers>
std::vector<PixelTriangle> owners(const SetupTriangles& triangles, const std::vector<OwnerPixel<Words, Layers>>& pixels,
                                  const Tile& tile, StageCounters& counters);

// `fragments`: made from owners(), shaded. Their areas are simd/conserve.h's, as in sorted order; but where a speck may
// be seen, whose area nobody has, areas are counted by positions alone, which has no bias. `last_pass`: positions that
// are still deferred are taken to look like the rest of the pixel. items_out: pixels that need another pass.
template <std::size_t Words, std::size_t Layers>
void settle(const std::vector<Fragment>& fragments, bool last_pass, StageCounters& counters,
            std::vector<OwnerPixel<Words, Layers>>& pixels);

// Before the first pass and after every one: is there anything to decide in the pixel?
template <std::size_t Words, std::size_t Layers>
bool is_unfinished(const OwnerPixel<Words, Layers>& pixel) {
  return !pixel.states.all_in(OwnerPixel<Words, Layers>::kSettled);
}

// Finished pixels are closed to all that comes, however near: a stencil test before anything is computed of a fragment.
template <std::size_t Words, std::size_t Layers>
void close_finished(const std::vector<OwnerPixel<Words, Layers>>& pixels, const Tile& tile, ClosedDepth& closed) {
  constexpr float kInFront = -2.0f;  // of every depth
  const OwnerPixel<Words, Layers>* pixel = pixels.data();
  for (std::int32_t y = tile.y0; y < tile.y1; ++y)
    for (std::int32_t x = tile.x0; x < tile.x1; ++x, ++pixel)
      if (!is_unfinished(*pixel)) closed.close(x, y, kInFront);
  closed.refresh();
}

// The box of the pixels that need another pass, its corners even; empty when there are none.
template <std::size_t Words, std::size_t Layers>
Tile unfinished_box(const std::vector<OwnerPixel<Words, Layers>>& pixels, const Tile& tile) {
  Tile box{tile.x1, tile.y1, tile.x0, tile.y0};
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    if (!is_unfinished(pixels[i])) continue;
    const auto x = tile.x0 + static_cast<std::int32_t>(i) % tile.width();
    const auto y = tile.y0 + static_cast<std::int32_t>(i) / tile.width();
    box = {std::min(box.x0, x & ~1), std::min(box.y0, y & ~1), std::max(box.x1, std::min((x | 1) + 1, tile.x1)),
           std::max(box.y1, std::min((y | 1) + 1, tile.y1))};
  }
  return box;
}

template <std::size_t Words, std::size_t Layers>
std::vector<PixelColor> settled_colors(const std::vector<OwnerPixel<Words, Layers>>& pixels);

}  // namespace beampipe
