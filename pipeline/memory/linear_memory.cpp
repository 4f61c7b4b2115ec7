#include "pipeline/memory/linear_memory.h"

namespace beampipe {

LinearMemory::LinearMemory(const MemorySystem& memory, std::size_t size, BlockPlaces places)
    : line_bytes_(memory.l2.line_bytes),
      l2_(memory, memory.l2, BlockCache::Level::l2, (size + line_bytes_ - 1) / line_bytes_, line_bytes_, false, nullptr,
          std::move(places)),
      l1_(memory, memory.l1, l2_) {
  const std::uint64_t bytes = std::uint64_t{l2_.blocks()} * line_bytes_;
  if (memory.reach) memory.reach->add({.l1 = bytes, .l2 = bytes});
}

template <class Access>
void LinearMemory::each_line(std::size_t begin, std::uint32_t bytes, Access&& access) const {
  const std::size_t end = begin + bytes;
  for (std::size_t at = begin; at < end;) {
    const std::size_t line = at / line_bytes_, stop = std::min(end, (line + 1) * line_bytes_);
    access(line, static_cast<std::uint32_t>(at % line_bytes_), static_cast<std::uint32_t>(stop - at));
    at = stop;
  }
}

void LinearMemory::write(std::uint32_t key, std::size_t begin, std::uint32_t bytes, StageCounters& counters) {
  each_line(begin, bytes, [&](std::size_t line, std::uint32_t first, std::uint32_t part) {
    l2_.write(key, line, first, part, counters);
  });
}

void LinearMemory::read(std::uint32_t key, std::size_t begin, std::uint32_t bytes, StageCounters& counters) {
  each_line(begin, bytes, [&](std::size_t line, std::uint32_t first, std::uint32_t part) {
    l1_.read(key, line, first, part, counters);
  });
}

void LinearMemory::read_through_l2(const std::vector<std::uint32_t>& begins, std::uint32_t bytes,
                                   StageCounters& counters) {
  for (const std::uint32_t begin : begins) {
    each_line(begin, bytes, [&](std::size_t line, std::uint32_t first, std::uint32_t part) {
      l2_.read(0, line, first, part, counters);
    });
  }
  l2_.finish_request();
}

void LinearMemory::flush(StageCounters& counters) {
  l1_.flush(counters);
  l2_.flush(counters);
}

}  // namespace beampipe
