// settle: the owners of a pass in streaming order -> the colours of the pixels. It ends a pass.
//
// The owners' areas are added to the pixels' colours, their positions become settled, and deferred positions become
// empty for the next pass.
#pragma once

#include <algorithm>
#include <vector>

#include "stages/cost/counters.h"
#include "stages/data/closed_depth.h"
#include "stages/data/fragment.h"
#include "stages/data/owner_pixel.h"
#include "stages/data/pair.h"
#include "stages/data/pixel_formats.h"
#include "stages/data/setup_triangle.h"
#include "stages/data/tile.h"

namespace beampipe {

// Returns the pairs whose fragments settle() needs: one for each layer of a pixel that owns a position, pixel by pixel.
// Charges reading the pixels that have owners, and writing the pairs.
template <std::size_t Words, std::size_t Layers>
std::vector<Pair> owners(const SetupTriangles& triangles, const std::vector<OwnerPixel<Words, Layers>>& pixels,
                         const Tile& tile, StageCounters& counters);

// `fragments`: the shaded fragments of the pairs from owners(). Areas follow simd/conserve.h, as in sorted order. The
// exception is a pixel in which a speck may be visible. Since the speck's area is not known, areas there are counted by
// positions alone, which has no bias. In the last pass, positions that are still deferred are assumed to look like the
// rest of the pixel. Counts as items out the pixels that need another pass.
template <std::size_t Words, std::size_t Layers>
void settle(const std::vector<Fragment>& fragments, bool last_pass, StageCounters& counters,
            std::vector<OwnerPixel<Words, Layers>>& pixels);

// Between passes: is any position of the pixel not yet settled?
template <std::size_t Words, std::size_t Layers>
bool is_unfinished(const OwnerPixel<Words, Layers>& pixel) {
  return !pixel.states.all_in(OwnerPixel<Words, Layers>::kSettled);
}

// Closes finished pixels to everything, however near. This acts like an early stencil test.
template <std::size_t Words, std::size_t Layers>
void close_finished(const std::vector<OwnerPixel<Words, Layers>>& pixels, const Tile& tile, ClosedDepth& closed) {
  const OwnerPixel<Words, Layers>* pixel = pixels.data();
  for (std::int32_t y = tile.y0; y < tile.y1; ++y)
    for (std::int32_t x = tile.x0; x < tile.x1; ++x, ++pixel)
      if (!is_unfinished(*pixel)) closed.close(x, y, kInFront);
  closed.refresh();
}

// The bounding box of the pixels that need another pass, with even corners. It is empty if there are none.
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
