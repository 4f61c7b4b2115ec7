// windows: sorted lists of (pixel, triangle) -> the next window of every open pixel.
//
// A window is a run of a pixel's list whose depth ranges overlap; windows lie strictly behind each other. One window
// per pixel is composed at a time, so that what lies behind a pixel's last position is never worked on. A record is
// read when it is looked at, which is once: the first behind a window starts the next one.
#pragma once

#include <cstdint>
#include <vector>

#include "stages/beam/a_buffer.h"

namespace beampipe {

// Does a record belong to the window before it, whose farthest depth is this?
template <class Float>
bool overlaps(Float nearest, Float farthest) {
  return nearest <= farthest;
}

class Windows {
 public:
  // `pairs` and `buffer`, which sorts them by nearest depth, must outlive it. `record_bytes`: of a pair in the buffer,
  // without its link.
  Windows(const std::vector<PixelTriangle>& pairs, const ABuffer& buffer, std::uint32_t record_bytes);

  // Replaces `window` by the next windows of the pixels whose lists have not ended and for which is_open(pixel): pixel
  // by pixel, each in primitive order. A pixel's first window that is one pair, which covers the pixel as a whole, goes
  // to `whole` instead: all that can be seen there is that triangle. Returns whether there are any.
  template <class IsOpen>
  bool next(IsOpen&& is_open, StageCounters& counters, std::vector<PixelTriangle>& window,
            std::vector<PixelTriangle>& whole) {
    window.clear(), whole.clear();
    std::erase_if(waiting_, [&](std::uint32_t pixel) { return !is_open(pixel); });
    Work work;
    for (const std::uint32_t pixel : waiting_) take(pixel, work, window, whole);
    count(work, waiting_.size(), window.size() + whole.size(), counters);
    std::erase_if(waiting_, [&](std::uint32_t pixel) { return next_[pixel] == buffer_.first[pixel + 1]; });
    return !window.empty() || !whole.empty();
  }

  // Per pixel: the pairs of its largest window so far, and of all its windows; and how many records were looked at.
  std::vector<float> largest, taken, looked_at;

 private:
  struct Work {
    std::uint64_t reads = 0;        // of records
    std::uint64_t range_tests = 0;  // does the next record's range overlap those before?
    std::uint64_t extensions = 0;   // by the next record's range
    std::uint64_t order_tests = 0;  // to have a window in primitive order
  };

  void take(std::uint32_t pixel, Work& work, std::vector<PixelTriangle>& window, std::vector<PixelTriangle>& whole);
  void count(const Work& work, std::size_t windows, std::size_t taken_now, StageCounters& counters) const;

  const std::vector<PixelTriangle>& pairs_;
  const ABuffer& buffer_;
  std::vector<std::uint32_t> next_;               // per pixel, into the buffer's records
  std::vector<std::uint32_t> waiting_;            // pixels with windows left
  std::vector<std::uint32_t> indices_, scratch_;  // of one window
  std::uint32_t record_bytes_;
};

}  // namespace beampipe
