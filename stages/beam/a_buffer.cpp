#include "stages/beam/a_buffer.h"

#include <algorithm>

#include "stages/beam/a_buffer_cost.h"
#include "stages/beam/merge_sort.h"

namespace beampipe {

std::vector<SortRecord> sort_records(const std::vector<Fragment>& fragments, SortKey key) {
  std::vector<SortRecord> records;
  records.reserve(fragments.size());
  for (const Fragment& fragment : fragments)
    records.push_back(
        {fragment.pixel, fragment.triangle, key == SortKey::centroid ? fragment.centroid_z : fragment.z_min});
  return records;
}

std::vector<SortRecord> sort_records(const std::vector<Pair>& pairs, const Tile& tile) {
  std::vector<SortRecord> records;
  records.reserve(pairs.size());
  for (const Pair& pair : pairs)
    records.push_back({static_cast<std::uint32_t>(tile.index(pair.x, pair.y)), pair.triangle, pair.nearest});
  return records;
}

ABuffer a_buffer(const std::vector<SortRecord>& records, std::size_t pixels, std::uint32_t item_bytes,
                 std::uint32_t record_bytes, StageCounters& counters) {
  ABuffer buffer;
  buffer.first.assign(pixels + 1, 0);
  for (const SortRecord& record : records) ++buffer.first[record.pixel + 1];
  for (std::size_t pixel = 0; pixel < pixels; ++pixel) buffer.first[pixel + 1] += buffer.first[pixel];
  struct Entry {
    float depth;
    std::uint32_t record;
  };
  std::vector<std::uint32_t> next(buffer.first.begin(), buffer.first.end() - 1);
  std::vector<Entry> lists(records.size()), scratch;
  for (std::uint32_t i = 0; i < records.size(); ++i) lists[next[records[i].pixel]++] = {records[i].depth, i};

  std::uint64_t comparisons = 0;
  for (std::size_t pixel = 0; pixel < pixels; ++pixel)
    comparisons += merge_sort(lists.data() + buffer.first[pixel], buffer.record_count(pixel), scratch,
                              [](const Entry& entry) { return entry.depth; });
  buffer.records.reserve(lists.size());
  for (const Entry& entry : lists) buffer.records.push_back(entry.record);
  charge(ABufferWork{records.size(), pixels, comparisons, item_bytes, record_bytes}, counters);
  return buffer;
}

std::vector<float> record_counts(const ABuffer& buffer) {
  std::vector<float> depths(buffer.first.size() - 1);
  for (std::size_t pixel = 0; pixel < depths.size(); ++pixel)
    depths[pixel] = static_cast<float>(buffer.record_count(pixel));
  return depths;
}

std::uint64_t a_buffer_bytes(std::uint64_t records, std::uint64_t pixels, std::uint32_t record_bytes) {
  return records * (record_bytes + kLinkBytes) + pixels * kLinkBytes;
}

}  // namespace beampipe
