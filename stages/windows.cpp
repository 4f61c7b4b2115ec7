#include "stages/windows.h"

#include <algorithm>

namespace beampipe {

Windows::Windows(const std::vector<PixelTriangle>& pairs, const ABuffer& buffer)
    : largest(buffer.first.size() - 1),
      taken(buffer.first.size() - 1),
      partial(buffer.first.size() - 1),
      pairs_(pairs),
      buffer_(buffer),
      next_(buffer.first.begin(), buffer.first.end() - 1) {
  for (std::uint32_t pixel = 0; pixel < next_.size(); ++pixel)
    if (buffer.depth_of(pixel) > 0) waiting_.push_back(pixel);
}

void Windows::take(std::uint32_t pixel, std::vector<PixelTriangle>& window, std::vector<PixelTriangle>& whole) {
  const std::uint32_t end = buffer_.first[pixel + 1];
  std::uint32_t& next = next_[pixel];
  indices_.clear();
  float farthest = pairs_[buffer_.records[next]].farthest;
  do {
    indices_.push_back(buffer_.records[next]);
    farthest = std::max(farthest, pairs_[indices_.back()].farthest);
  } while (++next < end && pairs_[buffer_.records[next]].nearest <= farthest);
  const auto size = static_cast<float>(indices_.size());
  const PixelTriangle& first = pairs_[indices_.front()];
  if (size == 1 && first.full && taken[pixel] == 0) {
    whole.push_back(first);
  } else {
    std::sort(indices_.begin(), indices_.end());
    for (const std::uint32_t index : indices_) window.push_back(pairs_[index]);
    partial[pixel] += size;
  }
  largest[pixel] = std::max(largest[pixel], size);
  taken[pixel] += size;
}

}  // namespace beampipe
