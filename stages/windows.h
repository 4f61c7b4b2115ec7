// windows: sorted lists of (pixel, triangle) -> the next window of every open pixel.
//
// A window is a run of a pixel's list whose depth ranges overlap; windows lie strictly behind each other. One window
// per pixel is composed at a time, so that what lies behind a pixel's last position is never worked on.
#pragma once

#include <cstdint>
#include <vector>

#include "stages/a_buffer.h"

namespace beampipe {

class Windows {
 public:
  // `pairs` and `buffer`, which sorts them by nearest depth, must outlive it.
  Windows(const std::vector<PixelTriangle>& pairs, const ABuffer& buffer);

  // Replaces `window` by the next windows of the pixels whose lists have not ended and for which is_open(pixel): pixel
  // by pixel, each in primitive order. A pixel's first window that is one pair, which covers the pixel as a whole, goes
  // to `whole` instead: all that can be seen there is that triangle. Returns whether there are any.
  template <class IsOpen>
  bool next(IsOpen&& is_open, std::vector<PixelTriangle>& window, std::vector<PixelTriangle>& whole) {
    window.clear(), whole.clear();
    std::erase_if(waiting_, [&](std::uint32_t pixel) { return !is_open(pixel); });
    for (const std::uint32_t pixel : waiting_) take(pixel, window, whole);
    std::erase_if(waiting_, [&](std::uint32_t pixel) { return next_[pixel] == buffer_.first[pixel + 1]; });
    return !window.empty() || !whole.empty();
  }

  // Per pixel: the pairs of its largest window so far, of all its windows, and of those that did not go to `whole`.
  std::vector<float> largest, taken, partial;

 private:
  void take(std::uint32_t pixel, std::vector<PixelTriangle>& window, std::vector<PixelTriangle>& whole);

  const std::vector<PixelTriangle>& pairs_;
  const ABuffer& buffer_;
  std::vector<std::uint32_t> next_;     // per pixel, into the buffer's records
  std::vector<std::uint32_t> waiting_;  // pixels with windows left
  std::vector<std::uint32_t> indices_;  // of one window
};

}  // namespace beampipe
