// Which draws of a frame put the same triangles at the same places, as a depth pre-pass and the draws after it do.
#pragma once

#include <cstdint>
#include <vector>

#include "traces/trace.h"

namespace beampipe {

// One number per draw of the frame. Two draws have the same number if their meshes have the same positions and
// triangles, and their transforms, viewports, scissors, depth ranges, biases and clipping are the same, and
// what decides which faces are drawn. The time is almost linear in the size of the draws' meshes.
std::vector<std::uint32_t> geometry_numbers(const Trace& trace, const Frame& frame);

}  // namespace beampipe
