// The history of a pixel of z3.
#pragma once

#include <cstddef>

#include "pipeline/inspect/inspected_pixel.h"
#include "stages/beam/compose_z3.h"

namespace beampipe {

template <std::size_t Words, std::size_t Layers>
PixelHistory inspect_z3(const InspectedPixel& pixel);

}  // namespace beampipe
