#include "pipeline/memory/linear_memory.h"

#include <bit>

namespace beampipe {

LinearMemory::LinearMemory(const MemorySystem& memory, std::size_t size, BlockPlaces places)
    : line_bytes_(memory.l2.line_bytes),
      log2_line_(std::countr_zero(line_bytes_)),
      l2_(memory, memory.l2, BlockCache::Level::l2,
          {.count = (size + line_bytes_ - 1) / line_bytes_, .bytes = line_bytes_, .places = std::move(places)}),
      l1_(memory, memory.l1, l2_) {
  const std::uint64_t bytes = std::uint64_t{l2_.blocks()} * line_bytes_;
  if (memory.reach) memory.reach->add({.l1 = bytes, .l2 = bytes});
}

template <class Access>
void LinearMemory::each_line(std::size_t begin, std::uint32_t bytes, Access&& access) const {
  const std::size_t end = begin + bytes;
  for (std::size_t at = begin; at < end;) {
    const std::size_t line = at >> log2_line_, stop = std::min(end, (line + 1) << log2_line_);
    access(line, static_cast<std::uint32_t>(at - (line << log2_line_)), static_cast<std::uint32_t>(stop - at));
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

void LinearMemory::fetch(std::size_t begin, std::uint32_t bytes, std::uint64_t times, StageCounters& counters) {
  const std::size_t lines = ((begin + bytes - 1) >> log2_line_) - (begin >> log2_line_) + 1;
  const std::uint64_t at_once = lines <= l1_.ways() ? times : 1;  // else the last line may have evicted the first
  for (std::uint64_t done = 0; done < times; done += at_once)
    each_line(begin, bytes, [&](std::size_t line, std::uint32_t first, std::uint32_t part) {
      l1_.fetch(line, first, part, at_once, counters);
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
