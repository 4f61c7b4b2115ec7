// settle: the end of a pass in streaming order. The owners' areas go into the pixels' colours, their positions are
// settled, and those that were deferred are free for the next pass.
#pragma once

#include <vector>

#include "stages/beam_fragment.h"
#include "stages/owner_pixel.h"
#include "stages/resolve.h"

namespace beampipe {

// What must be known again of the owners: one per pixel and layer, pixel by pixel.
template <std::size_t Words, std::size_t Layers>
std::vector<PixelTriangle> owners(const SetupTriangles& triangles, const std::vector<OwnerPixel<Words, Layers>>& pixels,
                                  const Tile& tile);

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

template <std::size_t Words, std::size_t Layers>
std::vector<PixelColor> settled_colors(const std::vector<OwnerPixel<Words, Layers>>& pixels);

}  // namespace beampipe
