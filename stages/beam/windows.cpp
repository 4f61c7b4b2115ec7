#include "stages/beam/windows.h"

#include <algorithm>

#include "stages/beam/merge_sort.h"
#include "stages/cost/counting.h"

namespace beampipe {
namespace {

OperationCounts range_test_cost() {
  return count_operations([](OperationCounts& counts) {
    const Counted<float> depth(0.0f, counts);
    overlaps(depth, depth);
  });
}

OperationCounts extension_cost() {
  return count_operations([](OperationCounts& counts) {
    const Counted<float> depth(0.0f, counts);
    greater(depth, depth);
  });
}

OperationCounts order_test_cost() {
  return count_operations([](OperationCounts& counts) {
    const Counted<std::uint32_t> index(0, counts);
    comes_first(index, index);
  });
}

}  // namespace

Windows::Windows(const std::vector<PixelTriangle>& pairs, const ABuffer& buffer, std::uint32_t record_bytes)
    : largest(buffer.first.size() - 1),
      taken(buffer.first.size() - 1),
      looked_at(buffer.first.size() - 1),
      pairs_(pairs),
      buffer_(buffer),
      next_(buffer.first.begin(), buffer.first.end() - 1),
      record_bytes_(record_bytes) {
  for (std::uint32_t pixel = 0; pixel < next_.size(); ++pixel)
    if (buffer.depth_of(pixel) > 0) waiting_.push_back(pixel);
}

void Windows::take(std::uint32_t pixel, Work& work, std::vector<PixelTriangle>& window,
                   std::vector<PixelTriangle>& whole) {
  const std::uint32_t end = buffer_.first[pixel + 1];
  std::uint32_t& next = next_[pixel];
  indices_.clear();
  float farthest = pairs_[buffer_.records[next]].farthest;
  do {
    indices_.push_back(buffer_.records[next]);
    farthest = greater(farthest, pairs_[indices_.back()].farthest);
  } while (++next < end && overlaps(pairs_[buffer_.records[next]].nearest, farthest));
  const auto size = static_cast<float>(indices_.size());
  const std::uint64_t tests = indices_.size() - (next == end);  // of the records behind the window's first
  work.range_tests += tests;
  work.extensions += indices_.size() - 1;
  const float looked = static_cast<float>(tests) + (taken[pixel] == 0 ? 1.0f : 0.0f);
  work.reads += static_cast<std::uint64_t>(looked);
  looked_at[pixel] += looked;
  const PixelTriangle& first = pairs_[indices_.front()];
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

void Windows::count(const Work& work, std::size_t windows, std::size_t taken_now, StageCounters& counters) const {
  static const UnitCost range_test = range_test_cost(), extension = extension_cost(), order_test = order_test_cost();
  counters.items_in += taken_now;
  counters.items_out += windows;
  counters.ops += range_test * work.range_tests;
  counters.ops += extension * work.extensions;
  counters.ops += order_test * work.order_tests;
  counters.bytes_read += work.reads * (record_bytes_ + kLinkBytes);
  counters.bytes_written += taken_now * kPairWithDepthBytes;
}

}  // namespace beampipe
