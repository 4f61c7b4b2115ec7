#include "pipeline/memory/a_buffer_memory.h"

namespace beampipe {

ABufferMemory::ABufferMemory(const MemorySystem& memory, const ZOrder& order, std::size_t records,
                             std::uint32_t record_bytes)
    : record_bytes_(record_bytes + kLinkBytes),
      heads_(memory, "a_buffer_heads", order, {.part_bytes = kLinkBytes}, BlockCache::Level::l2),
      records_(memory, records * record_bytes_, BlockPlaces(memory, "a_buffer", true)) {}

void ABufferMemory::insert(const std::vector<SortRecord>& records, StageCounters& counters) {
  for (std::uint32_t i = 0; i < records.size(); ++i) {
    heads_.access(records[i].triangle, records[i].pixel, 1, 1, counters);
    records_.write(records[i].triangle, std::size_t{i} * record_bytes_, record_bytes_, counters);
  }
  heads_.flush(counters);
  records_.flush(counters);
  heads_.read_all(counters);
}

void ABufferMemory::read_to_sort(std::uint32_t pixel, const ABuffer& buffer, StageCounters& counters) {
  for (std::uint32_t i = buffer.first[pixel]; i < buffer.first[pixel + 1]; ++i)
    read_record(pixel, buffer.records[i], counters);
}

void ABufferMemory::read_in_order(std::uint32_t pixel, const ABuffer& buffer, std::uint32_t read,
                                  StageCounters& counters) {
  for (std::uint32_t i = 0; i < read; ++i) read_record(pixel, buffer.records[buffer.first[pixel] + i], counters);
}

}  // namespace beampipe
