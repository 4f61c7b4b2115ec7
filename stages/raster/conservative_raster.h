// conservative_raster: setup triangles -> (pixel, triangle), every pixel whose closed square the closed triangle
// touches.
#pragma once

#include <cstdint>
#include <vector>

#include "stages/cost/counters.h"
#include "stages/data/closed_depth.h"
#include "stages/data/setup_triangle.h"
#include "stages/data/tile.h"

namespace beampipe {

struct PixelTriangle {
  std::uint32_t triangle;  // index into SetupTriangles
  std::uint32_t quad;      // pixels of one triangle in one 2x2 quad share it
  std::int32_t x, y;       // pixel, frame coordinates
  bool full;               // the triangle covers the whole pixel
  // Between these the triangle lies within the pixel: its plane over the whole pixel, cut by the depths of its
  // vertices.
  float nearest, farthest;
};

// Whether pairs are given their depths; else these are 0.
enum class PairDepths { bounds, none };

// Appends to `out`, triangle by triangle in the list's order. With `closed`, what cannot be seen behind triangles that
// cover whole pixels, of this list or of those before, is left out. Returns how many pairs waited in `out` before those
// were left out that a later triangle hides.
std::size_t conservative_raster(const SetupTriangles& triangles, const TriangleList& list, const Tile& tile,
                                StageCounters& counters, std::vector<PixelTriangle>& out, ClosedDepth* closed = nullptr,
                                PairDepths depths = PairDepths::bounds);

// The pair of a triangle and a pixel that it touches.
PixelTriangle pixel_triangle(const SetupTriangles& triangles, std::uint32_t index, std::uint32_t quad, std::int32_t x,
                             std::int32_t y, bool full);

}  // namespace beampipe
