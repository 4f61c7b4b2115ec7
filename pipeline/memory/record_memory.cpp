#include "pipeline/memory/record_memory.h"

namespace beampipe {

RecordMemory::RecordMemory(const MemorySystem& memory, std::string_view name, std::size_t pixels, const Chunks& chunks)
    : memory_(memory),
      chunk_bytes_(chunks.bytes),
      per_block_(memory.rop.line_bytes / chunks.bytes),
      records_(pixels),
      touched_(pixels),
      cache_(memory, memory.rop, BlockCache::Level::rop,
             {.count = pixels * chunks.most / per_block_ + 1,
              .bytes = per_block_ * chunk_bytes_,
              .cleared = true,
              .places = BlockPlaces(memory, name, true)}) {}

void RecordMemory::access(const RecordVisit& visit, StageCounters& counters) {
  std::vector<std::uint32_t>& record = records_[visit.pixel];
  resize(record, visit, counters);
  touched_[visit.pixel] += static_cast<std::uint32_t>(record.size());
  for (const std::uint32_t chunk : record) access_chunk(visit.key, chunk, visit.is_write, counters);
}

void RecordMemory::resize(std::vector<std::uint32_t>& record, const RecordVisit& visit, StageCounters& counters) {
  if (record.size() > visit.chunks) access_chunk(visit.key, record.back(), true, counters);  // its new link
  for (; record.size() > visit.chunks; record.pop_back()) free_.push_back(record.back());
  while (record.size() < visit.chunks) {
    if (free_.empty()) {
      record.push_back(never_taken_++);
    } else {
      record.push_back(free_.back());
      free_.pop_back();
    }
  }
}

void RecordMemory::access_chunk(std::uint32_t key, std::uint32_t chunk, bool is_write, StageCounters& counters) {
  const std::uint32_t first = chunk % per_block_ * chunk_bytes_;
  if (is_write) {
    cache_.write(key, chunk / per_block_, first, chunk_bytes_, counters);
  } else {
    cache_.read(key, chunk / per_block_, first, chunk_bytes_, counters);
  }
}

void RecordMemory::flush(StageCounters& counters) {
  cache_.flush(counters);
  const std::uint64_t blocks = (never_taken_ + per_block_ - 1) / per_block_;
  if (memory_.reach) memory_.reach->add({.rop = blocks * memory_.rop.line_bytes});
}

void RecordMemory::add_bytes(std::vector<float>& pixels) const {
  for (std::size_t i = 0; i < pixels.size(); ++i) pixels[i] += static_cast<float>(touched_[i] * chunk_bytes_);
}

}  // namespace beampipe
