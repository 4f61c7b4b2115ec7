// The history of a pixel of beam in sorted order.
#pragma once

#include <cstddef>

#include "pipeline/inspect/inspected_pixel.h"
#include "stages/data/beam_aggregate.h"

namespace beampipe {

template <std::size_t Words, class Channel>
PixelHistory inspect_sorted(const InspectedPixel& pixel);

}  // namespace beampipe
