#include "stages/a_buffer.h"

#include <algorithm>

#include "stages/counting.h"
#include "stages/merge_sort.h"

namespace beampipe {
namespace {

OperationCounts comparison_cost() {
  return count_operations([](OperationCounts& counts) {
    const Counted<float> depth(0.0f, counts);
    comes_first(depth, depth);
  });
}

}  // namespace

ABuffer a_buffer(const std::vector<Fragment>& fragments, std::size_t pixels, SortKey key, std::uint32_t record_bytes,
                 StageCounters& counters) {
  ABuffer buffer;
  buffer.first.assign(pixels + 1, 0);
  for (const Fragment& fragment : fragments) ++buffer.first[fragment.pixel + 1];
  for (std::size_t pixel = 0; pixel < pixels; ++pixel) buffer.first[pixel + 1] += buffer.first[pixel];
  std::vector<std::uint32_t> next(buffer.first.begin(), buffer.first.end() - 1);
  buffer.fragments.resize(fragments.size());
  for (std::uint32_t i = 0; i < fragments.size(); ++i) buffer.fragments[next[fragments[i].pixel]++] = i;

  std::uint64_t comparisons = 0;
  std::vector<std::uint32_t> scratch;
  for (std::size_t pixel = 0; pixel < pixels; ++pixel) {
    comparisons += merge_sort(
        buffer.fragments.data() + buffer.first[pixel], buffer.depth_of(pixel), scratch,
        [&](std::uint32_t i) { return key == SortKey::centroid ? fragments[i].centroid_z : fragments[i].z_min; });
  }
  counters.items_in += fragments.size();
  counters.items_out += fragments.size();
  counters.ops += comparison_cost() * comparisons;
  counters.bytes_read += a_buffer_bytes(fragments.size(), pixels, record_bytes);
  counters.bytes_written += a_buffer_bytes(fragments.size(), pixels, record_bytes);
  return buffer;
}

std::uint64_t a_buffer_bytes(std::uint64_t fragments, std::uint64_t pixels, std::uint32_t record_bytes) {
  return fragments * (record_bytes + kLinkBytes) + pixels * kLinkBytes;
}

}  // namespace beampipe
