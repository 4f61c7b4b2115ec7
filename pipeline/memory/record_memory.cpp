#include "pipeline/memory/record_memory.h"

#include <algorithm>

namespace beampipe {
namespace {

constexpr std::uint32_t kLinkedChunkBytes = kChunkBytes + kChunkLinkBytes;

// A share is at most a line of the cache, which is what a surface is cached by.
std::uint32_t chunks_of_share(const MemorySystem& memory, std::uint32_t bytes_per_pixel) {
  const std::uint32_t most = std::max(memory.rop.line_bytes / kLinkedChunkBytes, 1u);
  return std::clamp(bytes_per_pixel / kLinkedChunkBytes, 1u, most);
}

}  // namespace

RecordMemory::RecordMemory(const MemorySystem& memory, std::string_view name, const ZOrder& order,
                           std::uint32_t bytes_per_pixel)
    : order_(order),
      share_(chunks_of_share(memory, bytes_per_pixel)),
      surface_(memory, name, order, {.parts = share_, .part_bytes = kLinkedChunkBytes}) {}

void RecordMemory::access(const RecordVisit& visit, StageCounters& counters) {
  std::uint32_t position = order_.of[visit.pixel];
  for (std::uint32_t left = visit.chunks; left > 0;) {
    const std::uint32_t here = std::min(left, share_), parts = (1u << here) - 1;
    surface_.access_at(visit.key, position, visit.is_write ? 0 : parts, visit.is_write ? parts : 0, counters);
    left -= here;
    position = (position + 1) % static_cast<std::uint32_t>(order_.positions);
  }
}

}  // namespace beampipe
