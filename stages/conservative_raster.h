// conservative_raster: setup triangles -> (pixel, triangle), every pixel whose closed square the closed triangle
// touches.
#pragma once

#include <cstdint>
#include <vector>

#include "stages/counters.h"
#include "stages/setup_triangle.h"
#include "stages/tile.h"

namespace beampipe {

struct PixelTriangle {
  std::uint32_t triangle;  // index into SetupTriangles
  std::uint32_t quad;      // pixels of one triangle in one 2x2 quad share it
  std::int32_t x, y;       // pixel, frame coordinates
  bool full;               // the triangle covers the whole pixel
};

// Appends to `out`, triangle by triangle in the list's order.
void conservative_raster(const SetupTriangles& triangles, const TriangleList& list, const Tile& tile,
                         StageCounters& counters, std::vector<PixelTriangle>& out);

}  // namespace beampipe
