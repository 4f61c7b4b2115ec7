#include "pipeline/memory/beam_memory.h"

#include <algorithm>

#include "pipeline/memory/image_memory.h"

namespace beampipe {

ABufferMemory::ABufferMemory(const MemoryParameters& parameters, const ZOrder& order, std::size_t fragments,
                             std::uint32_t record_bytes)
    : record_bytes_(record_bytes + kLinkBytes),
      line_bytes_(parameters.l2.line_bytes),
      heads_(parameters, order, kLinkBytes),
      records_(parameters, parameters.l2, (fragments * record_bytes_ + line_bytes_ - 1) / line_bytes_, line_bytes_,
               false, nullptr) {}

void ABufferMemory::insert(const std::vector<Fragment>& fragments, StageCounters& counters) {
  for (std::uint32_t i = 0; i < fragments.size(); ++i) {
    heads_.access(fragments[i].triangle, fragments[i].pixel, 1, 1, kLinkBytes, counters);
    access(fragments[i].triangle, i, true, counters);
  }
  heads_.flush(counters);
  records_.flush(counters);
  heads_.read_all(counters);
}

void ABufferMemory::sort(std::uint32_t pixel, const ABuffer& buffer, StageCounters& counters) {
  for (std::uint32_t i = buffer.first[pixel]; i < buffer.first[pixel + 1]; ++i)
    access(pixel, buffer.fragments[i], false, counters);
}

void ABufferMemory::compose(std::uint32_t pixel, const ABuffer& buffer, std::uint32_t merged, StageCounters& counters) {
  for (std::uint32_t i = 0; i < merged; ++i) access(pixel, buffer.fragments[buffer.first[pixel] + i], false, counters);
}

void ABufferMemory::access(std::uint32_t key, std::uint32_t record, bool write, StageCounters& counters) {
  const std::size_t begin = std::size_t{record} * record_bytes_, end = begin + record_bytes_;
  for (std::size_t at = begin; at < end;) {
    const std::size_t block = at / line_bytes_, stop = std::min(end, (block + 1) * line_bytes_);
    const auto first = static_cast<std::uint32_t>(at % line_bytes_), bytes = static_cast<std::uint32_t>(stop - at);
    write ? records_.write(key, block, first, bytes, counters) : records_.read(key, block, first, bytes, counters);
    at = stop;
  }
}

AggregateMemory::AggregateMemory(const MemoryParameters& parameters, const ZOrder& order,
                                 const std::vector<Surface>& framebuffer)
    : order_(order), full_(order.positions) {
  surfaces_.reserve(framebuffer.size());
  for (const Surface& surface : framebuffer) {
    TileSurface::CompressedBytes compressed;
    if (surface.name == "coverage" || surface.name == "mask") {
      compressed = [this, bytes = surface.bytes_per_pixel](std::size_t first, std::size_t elements) {
        const std::size_t end = std::min(first + elements, full_.size());
        const auto begin = full_.begin() + static_cast<std::ptrdiff_t>(first);
        const bool all = std::find(begin, full_.begin() + static_cast<std::ptrdiff_t>(end), false) ==
                         full_.begin() + static_cast<std::ptrdiff_t>(end);
        return all ? bytes : bytes * static_cast<std::uint32_t>(elements);
      };
    }
    surfaces_.emplace_back(parameters, order, surface.bytes_per_pixel, compressed);
  }
}

void AggregateMemory::merge(std::uint32_t triangle, std::uint32_t pixel, StageCounters& counters) {
  for (TileSurface& surface : surfaces_) {
    surface.read(triangle, pixel, counters);
    surface.write(triangle, pixel, counters);
  }
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

void count_sorted_composition(const MemoryParameters& parameters, const Tile& tile, const ABuffer& buffer,
                              const std::vector<Fragment>& fragments, std::uint32_t record_bytes,
                              const std::vector<float>& merged, const std::vector<bool>& full,
                              const std::vector<Surface>& framebuffer, StageCounters& buffering,
                              StageCounters& composition, StageCounters& resolving) {
  if (!parameters.modelled) return;
  const ZOrder order(tile.width(), tile.height());
  ABufferMemory a_buffer(parameters, order, fragments.size(), record_bytes);
  AggregateMemory aggregates(parameters, order, framebuffer);
  a_buffer.insert(fragments, buffering);
  std::vector<std::uint32_t> pixel_at(order.positions, ~0u);
  for (std::uint32_t pixel = 0; pixel < tile.pixels(); ++pixel) pixel_at[order.of[pixel]] = pixel;
  for (const std::uint32_t pixel : pixel_at) {
    if (pixel == ~0u || buffer.depth_of(pixel) == 0) continue;
    a_buffer.sort(pixel, buffer, buffering);
    a_buffer.compose(pixel, buffer, static_cast<std::uint32_t>(merged[pixel]), composition);
    aggregates.write(pixel, composition);
  }
  a_buffer.finish(composition);
  aggregates.flush(full, composition);
  aggregates.read_all(resolving);
  write_image(parameters, tile, resolving);
}

}  // namespace beampipe
