#include "stages/beam/windows.h"

#include <algorithm>

#include "simd/scalar.h"
#include "stages/beam/merge_sort.h"
#include "stages/beam/windows_cost.h"

namespace beampipe {

Windows::Windows(const std::vector<Pair>& pairs, const ABuffer& buffer, std::uint32_t record_bytes)
    : largest(buffer.first.size() - 1),
      taken(buffer.first.size() - 1),
      looked_at(buffer.first.size() - 1),
      pairs_(pairs),
      buffer_(buffer),
      next_(buffer.first.begin(), buffer.first.end() - 1),
      record_bytes_(record_bytes) {
  for (std::uint32_t pixel = 0; pixel < next_.size(); ++pixel)
    if (buffer.record_count(pixel) > 0) waiting_.push_back(pixel);
}

void Windows::take(std::uint32_t pixel, WindowsWork& work, std::vector<Pair>& window, std::vector<Pair>& whole) {
  const std::uint32_t first_record = buffer_.first[pixel], end = buffer_.first[pixel + 1];
  std::uint32_t& next = next_[pixel];
  indices_.clear();
  float farthest = pairs_[buffer_.records[next]].farthest;
  bool belongs = true;  // does the record at `next`?
  do {
    indices_.push_back(buffer_.records[next++]);
    farthest = greater(farthest, pairs_[indices_.back()].farthest);
    if (next == end) break;
    belongs = overlaps(pairs_[buffer_.records[next]].nearest, farthest);
    ++work.range_tests;
  } while (belongs);
  const auto size = static_cast<float>(indices_.size());
  work.extensions += indices_.size() - 1;
  const auto looked = static_cast<float>(next - first_record + (belongs ? 0 : 1));  // so far
  work.reads += static_cast<std::uint64_t>(looked - looked_at[pixel]);
  looked_at[pixel] = looked;
  const Pair& first = pairs_[indices_.front()];
  if (size == 1 && first.full && taken[pixel] == 0) {
    whole.push_back(first);
  } else {
    work.order_tests +=
        merge_sort(indices_.data(), indices_.size(), scratch_, [](std::uint32_t index) { return index; });
    for (const std::uint32_t index : indices_) window.push_back(pairs_[index]);
  }
  largest[pixel] = std::max(largest[pixel], size);
  taken[pixel] += size;
}

void Windows::count(const WindowsWork& work, std::size_t windows, std::size_t taken_now,
                    StageCounters& counters) const {
  charge(work, windows, taken_now, record_bytes_, counters);
}

}  // namespace beampipe
