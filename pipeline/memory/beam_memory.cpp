#include "pipeline/memory/beam_memory.h"

#include <algorithm>

#include "pipeline/memory/image_memory.h"

namespace beampipe {

ABufferMemory::ABufferMemory(const MemoryParameters& parameters, const ZOrder& order, std::size_t records,
                             std::uint32_t record_bytes)
    : record_bytes_(record_bytes + kLinkBytes),
      heads_(parameters, order, 1, kLinkBytes, nullptr, BlockCache::Level::l2),
      records_(parameters, records * record_bytes_) {}

void ABufferMemory::insert(const std::vector<SortRecord>& records, StageCounters& counters) {
  for (std::uint32_t i = 0; i < records.size(); ++i) {
    heads_.access(records[i].triangle, records[i].pixel, 1, 1, counters);
    records_.write(records[i].triangle, std::size_t{i} * record_bytes_, record_bytes_, counters);
  }
  heads_.flush(counters);
  records_.flush(counters);
  heads_.read_all(counters);
}

void ABufferMemory::sort(std::uint32_t pixel, const ABuffer& buffer, StageCounters& counters) {
  for (std::uint32_t i = buffer.first[pixel]; i < buffer.first[pixel + 1]; ++i)
    read_record(pixel, buffer.records[i], counters);
}

void ABufferMemory::compose(std::uint32_t pixel, const ABuffer& buffer, std::uint32_t merged, StageCounters& counters) {
  for (std::uint32_t i = 0; i < merged; ++i) read_record(pixel, buffer.records[buffer.first[pixel] + i], counters);
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
    surfaces_.emplace_back(parameters, order, 1, surface.bytes_per_pixel, compressed);
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

void AggregateMemory::add_bytes(std::vector<float>& pixels) const {
  for (const TileSurface& surface : surfaces_) surface.add_bytes(pixels);
}

namespace {

// Calls visit(pixel) for the tile's pixels that have records, in Z order.
template <class Visit>
void for_each_list(const ZOrder& order, const Tile& tile, const ABuffer& buffer, Visit&& visit) {
  std::vector<std::uint32_t> pixel_at(order.positions, ~0u);
  for (std::uint32_t pixel = 0; pixel < tile.pixels(); ++pixel) pixel_at[order.of[pixel]] = pixel;
  for (const std::uint32_t pixel : pixel_at)
    if (pixel != ~0u && buffer.depth_of(pixel) > 0) visit(pixel);
}

}  // namespace

std::vector<float> count_sorted_composition(const MemoryParameters& parameters, const Tile& tile, const ABuffer& buffer,
                                            const std::vector<SortRecord>& records, std::uint32_t record_bytes,
                                            const std::vector<float>& merged, const std::vector<bool>& written,
                                            const std::vector<bool>& full, const std::vector<Surface>& framebuffer,
                                            StageCounters& buffering, StageCounters& fetching,
                                            StageCounters& composition, StageCounters& resolving) {
  std::vector<float> bytes(tile.pixels());
  if (!parameters.modelled) return bytes;
  const ZOrder order(tile.width(), tile.height());
  ABufferMemory a_buffer(parameters, order, records.size(), record_bytes);
  AggregateMemory aggregates(parameters, order, framebuffer);
  a_buffer.insert(records, buffering);
  for (std::uint32_t pixel = 0; pixel < bytes.size(); ++pixel)
    bytes[pixel] = a_buffer.bytes_of(buffer.depth_of(pixel), static_cast<std::uint32_t>(merged[pixel]));
  for_each_list(order, tile, buffer, [&](std::uint32_t pixel) {
    a_buffer.sort(pixel, buffer, buffering);
    a_buffer.compose(pixel, buffer, static_cast<std::uint32_t>(merged[pixel]), fetching);
    if (written[pixel]) aggregates.write(pixel, composition);
  });
  a_buffer.finish(fetching);
  aggregates.flush(full, composition);
  aggregates.read_all(resolving);
  write_image(parameters, tile, resolving);
  aggregates.add_bytes(bytes);
  return bytes;
}

}  // namespace beampipe
