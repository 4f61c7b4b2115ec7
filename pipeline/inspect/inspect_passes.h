// The history of a pixel of beam in streaming order with several passes.
#pragma once

#include <cstddef>

#include "pipeline/inspect/inspected_pixel.h"
#include "stages/data/owner_pixel.h"

namespace beampipe {

// `passes`: the most; 0: until the pixel is settled.
template <std::size_t Words, std::size_t Layers>
PixelHistory inspect_passes(const InspectedPixel& pixel, int passes);

}  // namespace beampipe
