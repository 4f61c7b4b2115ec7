#include "pipeline/memory/aggregate_memory.h"

#include <algorithm>

namespace beampipe {

AggregateMemory::AggregateMemory(const MemorySystem& memory, const ZOrder& order,
                                 const std::vector<Surface>& framebuffer)
    : order_(order), full_(order.positions) {
  surfaces_.reserve(framebuffer.size());
  for (const Surface& surface : framebuffer) {
    TileSurface::Element pixel{.part_bytes = surface.bytes_per_pixel};
    if (surface.name == "coverage" || surface.name == "mask") {
      pixel.compressed_bytes = [this, bytes = surface.bytes_per_pixel](std::size_t first, std::size_t elements) {
        const std::size_t end = std::min(first + elements, full_.size());
        const auto begin = full_.begin() + static_cast<std::ptrdiff_t>(first);
        const bool all = std::find(begin, full_.begin() + static_cast<std::ptrdiff_t>(end), false) ==
                         full_.begin() + static_cast<std::ptrdiff_t>(end);
        return all ? bytes : bytes * static_cast<std::uint32_t>(elements);
      };
    }
    surfaces_.emplace_back(memory, surface.name, order, pixel);
  }
}

void AggregateMemory::merge(std::uint32_t triangle, std::uint32_t pixel, StageCounters& counters) {
  for (TileSurface& surface : surfaces_) surface.access(triangle, pixel, 1, 1, counters);
}

void AggregateMemory::read(std::uint32_t pixel, StageCounters& counters) {
  for (TileSurface& surface : surfaces_) surface.read(0, pixel, counters);
}

void AggregateMemory::write(std::uint32_t pixel, StageCounters& counters) {
  for (TileSurface& surface : surfaces_) surface.write(0, pixel, counters);
}

void AggregateMemory::flush(const std::vector<bool>& full, StageCounters& counters) {
  for (std::size_t pixel = 0; pixel < full.size(); ++pixel) full_[order_.of[pixel]] = full[pixel];
  for (TileSurface& surface : surfaces_) surface.flush(counters);
}

void AggregateMemory::read_all(StageCounters& counters) {
  for (TileSurface& surface : surfaces_) surface.read_all(counters);
}

void AggregateMemory::add_bytes(std::vector<float>& pixels) const {
  for (const TileSurface& surface : surfaces_) surface.add_bytes(pixels);
}

}  // namespace beampipe
