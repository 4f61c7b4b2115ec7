// A picture of a frame, compared with the one that the captured program drew (Frame::capture.pictures.color).
//
// Both are codes of 8 bits, as a screen gets them. The program's own picture was rounded once; ours is close where it
// differs by no more than two codes in all three channels.
#pragma once

#include <cstdint>
#include <vector>

#include "pipeline/technique.h"
#include "tools/evaluate/captured_check.h"

namespace beampipe {

struct ColorCheck {
  static constexpr int kClose = 2;  // codes, in each channel

  std::uint64_t pixels = 0, close = 0;
  int largest = 0;                    // difference, in codes
  std::vector<DrawDifference> draws;  // those that differ, the one with most differing pixels first; of these,
                                      // `largest` is in codes

  double close_part() const;  // of the pixels
};

// `draws`: of each pixel the draw that has it, as SampledDepths::draw. Throws std::invalid_argument unless the frame
// has a captured picture, and `image` and `draws` have its size.
ColorCheck check_colors(const Trace& trace, const Frame& frame, const Image& image,
                        const std::vector<std::uint32_t>& draws);

// RGB, three bytes per pixel: of each channel the difference in codes, times 8. Black: equal.
std::vector<std::uint8_t> color_difference_picture(const Trace& trace, const Frame& frame, const Image& image);

}  // namespace beampipe
