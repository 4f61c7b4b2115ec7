#include "pipeline/units/a_buffer_unit.h"

#include "pipeline/memory/a_buffer_memory.h"

namespace beampipe {

ABufferUnit::ABufferUnit(Bin& bin, std::uint32_t item_bytes, std::uint32_t record_bytes)
    : bin_(bin), stage_(bin.stage(StageId::a_buffer)), item_bytes_(item_bytes), record_bytes_(record_bytes) {}

const ABuffer& ABufferUnit::operator()(std::vector<SortRecord> records) {
  records_ = std::move(records);
  lists_ = a_buffer(records_, bin_.tile.pixels(), item_bytes_, record_bytes_, stage_.timed());
  bin_.keeps_a_buffer(a_buffer_bytes(records_.size(), bin_.tile.pixels(), record_bytes_));
  bin_.pixel_counter("fragments") = record_counts(lists_);
  return lists_;
}

void ABufferUnit::charge_memory(const std::vector<float>& read, const BinStage& reader) {
  if (!bin_.models_memory()) return;
  ABufferMemory memory(bin_.memory(), bin_.z_order(), records_.size(), record_bytes_);
  memory.insert(records_, stage_.counters);
  std::vector<float>& bytes = bin_.pixel_counter("bytes");
  for_each_list(bin_.z_order(), bin_.tile, lists_, [&](std::uint32_t pixel) {
    memory.read_to_sort(pixel, lists_, stage_.counters);
    memory.read_in_order(pixel, lists_, static_cast<std::uint32_t>(read[pixel]), reader.counters);
  });
  for (std::uint32_t pixel = 0; pixel < bytes.size(); ++pixel)
    bytes[pixel] += memory.bytes_of(lists_.record_count(pixel), static_cast<std::uint32_t>(read[pixel]));
  memory.finish(reader.counters);
}

}  // namespace beampipe
