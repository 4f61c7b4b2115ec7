// The history of a pixel of beam in near-first order, and in streaming order with one pass.
#pragma once

#include <cstddef>

#include "pipeline/inspect/inspected_pixel.h"
#include "stages/beam/compose_owners.h"
#include "stages/data/open_pixel.h"

namespace beampipe {

enum class OwnerOrder { near_first, stream };

template <std::size_t Words, std::size_t Slots>
PixelHistory inspect_owners(const InspectedPixel& pixel, OwnerOrder order, OwnerPlace shade_at);

}  // namespace beampipe
