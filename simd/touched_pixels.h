// The pixels that a triangle touches, one by one, with bounds of its depth in each.
#pragma once

#include <cstddef>
#include <cstdint>

#include "simd/depth_bounds.h"
#include "simd/quad_rows.h"

namespace beampipe {

// A row of quads of pixels. (x, y) is the upper left pixel of the first quad, in frame coordinates; `quad` its number.
struct PixelRow {
  std::int32_t x, y;
  std::uint32_t quad;
  QuadRow pixels;
};

inline constexpr std::size_t kRowsInBlock = 8;
inline constexpr std::size_t kPixelsInBlock = kRowsInBlock * 4 * kQuadsPerRow;

// Columns of pixels.
struct TouchedPixels {
  static constexpr std::size_t kRoom = kPixelsInBlock + 16;  // vectors are stored whole

  alignas(64) std::int32_t x[kRoom], y[kRoom];  // frame coordinates
  alignas(64) std::uint32_t quad[kRoom];
  alignas(64) std::uint32_t full[kRoom];              // not 0: the triangle covers the whole pixel
  alignas(64) float nearest[kRoom], farthest[kRoom];  // as pair_bounds
};

// Lists what is touched in up to kRowsInBlock rows, in the order of the rows and of their bits, and returns the number
// of pixels. `vertices`: bounds of the triangle's depth anywhere. Lanes are across pixels. The bounds have the same
// bits as pair_bounds of the plane at each pixel's centre, rounded to float, on every target.
std::size_t touched_pixels(const PixelRow* rows, std::size_t count, const AnchoredPlane<double>& plane,
                           const DepthBounds<float>& vertices, TouchedPixels& out);

}  // namespace beampipe
