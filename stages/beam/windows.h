// windows: sorted lists of pairs -> the next window of every open pixel.
//
// A window is a run of a pixel's list whose depth ranges overlap, so windows lie strictly behind each other. Pixels are
// composed one window at a time. Once all positions are taken, farther windows are skipped. Each record is read only
// once: the record that ends a window starts the next one.
#pragma once

#include <cstdint>
#include <vector>

#include "stages/cost/counters.h"
#include "stages/data/pair.h"
#include "stages/data/sorted_lists.h"

namespace beampipe {

// Does a record whose nearest depth is `nearest` belong to a window whose farthest depth so far is `farthest`?
template <class Float>
bool overlaps(Float nearest, Float farthest) {
  return nearest <= farthest;
}

// How often each operation was done; stages/beam/windows_cost.h charges it.
struct WindowsWork {
  std::uint64_t reads = 0;        // of records
  std::uint64_t range_tests = 0;  // does the next record's depth range overlap the window?
  std::uint64_t extensions = 0;   // of the window's depth range by the next record's
  std::uint64_t order_tests = 0;  // to sort a window into primitive order
};

class Windows {
 public:
  // `buffer` sorts `pairs` by their nearest depth; both must outlive this object. `record_bytes`: size of a pair in the
  // buffer, without its link.
  Windows(const std::vector<Pair>& pairs, const ABuffer& buffer, std::uint32_t record_bytes);

  // Replaces `window` by the next windows of all pixels that have records left and for which is_open(pixel) is true:
  // pixel by pixel, and in primitive order within each. If a pixel's first window is a single pair that covers the
  // whole pixel, nothing else can be visible there; that pair goes to `whole` instead. Returns whether there are any
  // pairs.
  template <class IsOpen>
  bool next(IsOpen&& is_open, StageCounters& counters, std::vector<Pair>& window, std::vector<Pair>& whole) {
    window.clear(), whole.clear();
    std::erase_if(waiting_, [&](std::uint32_t pixel) { return !is_open(pixel); });
    WindowsWork work;
    for (const std::uint32_t pixel : waiting_) take(pixel, work, window, whole);
    count(work, waiting_.size(), window.size() + whole.size(), counters);
    std::erase_if(waiting_, [&](std::uint32_t pixel) { return next_[pixel] == buffer_.first[pixel + 1]; });
    return !window.empty() || !whole.empty();
  }

  // Per pixel, so far: the pairs of its largest window, the pairs of all its windows, and the records that were read.
  std::vector<float> largest, taken, looked_at;

 private:
  void take(std::uint32_t pixel, WindowsWork& work, std::vector<Pair>& window, std::vector<Pair>& whole);
  void count(const WindowsWork& work, std::size_t windows, std::size_t taken_now, StageCounters& counters) const;

  const std::vector<Pair>& pairs_;
  const ABuffer& buffer_;
  std::vector<std::uint32_t> next_;               // per pixel: the next record, an index into the buffer's records
  std::vector<std::uint32_t> waiting_;            // pixels that have records left
  std::vector<std::uint32_t> indices_, scratch_;  // of one window
  std::uint32_t record_bytes_;
};

}  // namespace beampipe
