// A triangle that a stage shades where it needs the colour, and not as a fragment.
#pragma once

#include <cstdint>

namespace beampipe {

struct ShadedTriangle {
  std::uint32_t triangle;  // index into SetupTriangles
  std::uint32_t pixel;     // index within the tile, row by row
  float u, v;              // in the pixel, from its upper left corner, 0..1
};

}  // namespace beampipe
