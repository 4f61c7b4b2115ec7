#include "stages/a_buffer.h"

#include <algorithm>

#include "stages/aggregate_format.h"

namespace beampipe {

ABuffer a_buffer(const std::vector<Fragment>& fragments, std::size_t pixels, StageCounters& counters) {
  ABuffer buffer;
  buffer.first.assign(pixels + 1, 0);
  for (const Fragment& fragment : fragments) ++buffer.first[fragment.pixel + 1];
  for (std::size_t pixel = 0; pixel < pixels; ++pixel) buffer.first[pixel + 1] += buffer.first[pixel];
  std::vector<std::uint32_t> next(buffer.first.begin(), buffer.first.end() - 1);
  buffer.fragments.resize(fragments.size());
  for (std::uint32_t i = 0; i < fragments.size(); ++i) buffer.fragments[next[fragments[i].pixel]++] = i;

  std::uint64_t comparisons = 0;
  for (std::size_t pixel = 0; pixel < pixels; ++pixel) {
    const auto begin = buffer.fragments.begin() + buffer.first[pixel];
    const auto end = buffer.fragments.begin() + buffer.first[pixel + 1];
    std::sort(begin, end, [&](std::uint32_t i, std::uint32_t j) {
      ++comparisons;
      const float zi = fragments[i].centroid_z, zj = fragments[j].centroid_z;
      return zi < zj || (zi == zj && i < j);
    });
  }
  counters.items_in += fragments.size();
  counters.items_out += fragments.size();
  counters.ops.add += comparisons;
  counters.bytes_read += fragments.size() * (kAggregateBytes + kLinkBytes) + pixels * kLinkBytes;
  counters.bytes_written += fragments.size() * (kAggregateBytes + kLinkBytes) + pixels * kLinkBytes;
  return buffer;
}

std::uint64_t a_buffer_bytes(std::uint64_t fragments, std::uint64_t pixels) {
  return fragments * (kAggregateBytes + kLinkBytes) + pixels * kLinkBytes;
}

}  // namespace beampipe
