// A pair: a pixel and a triangle that touches it. Pairs go from conservative_raster to beam_fragment.
#pragma once

#include <cstdint>

#include "stages/data/pixel_depth.h"
#include "stages/data/setup_triangle.h"

namespace beampipe {

struct Pair {
  std::uint32_t triangle;  // index into SetupTriangles
  std::uint32_t quad;      // the same number for all pixels of one triangle in one 2x2 quad
  std::int32_t x, y;       // pixel, frame coordinates
  bool full;               // the triangle covers and hides the whole pixel
  // Bounds of the triangle's depth in the pixel (pair_bounds in stages/data/pixel_depth.h).
  float nearest, farthest;
};

// Sizes of a pair in the modelled machine. Between two stages: 16-bit x and y and a 32-bit triangle index; `full` fits
// into a spare bit.
inline constexpr std::uint32_t kPairBytes = 8;

// The same with the two depth bounds as float32.
inline constexpr std::uint32_t kPairWithDepthBytes = kPairBytes + 8;

// In the A-buffer: the triangle index and the two depth bounds.
inline constexpr std::uint32_t kStoredPairBytes = 4 + 8;

}  // namespace beampipe
