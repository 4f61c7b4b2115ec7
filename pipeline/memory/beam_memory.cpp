#include "pipeline/memory/beam_memory.h"

#include <algorithm>

#include "pipeline/memory/image_memory.h"

namespace beampipe {

LinearMemory::LinearMemory(const MemoryParameters& parameters, std::size_t records, std::uint32_t record_bytes)
    : record_bytes_(record_bytes),
      line_bytes_(parameters.l2.line_bytes),
      l2_(parameters, parameters.l2, BlockCache::Level::l2, (records * record_bytes_ + line_bytes_ - 1) / line_bytes_,
          line_bytes_, false, nullptr),
      l1_(parameters, parameters.l1, l2_) {}

template <class Access>
void LinearMemory::each_line(std::uint32_t record, Access&& access) const {
  const std::size_t begin = std::size_t{record} * record_bytes_, end = begin + record_bytes_;
  for (std::size_t at = begin; at < end;) {
    const std::size_t block = at / line_bytes_, stop = std::min(end, (block + 1) * line_bytes_);
    access(block, static_cast<std::uint32_t>(at % line_bytes_), static_cast<std::uint32_t>(stop - at));
    at = stop;
  }
}

void LinearMemory::write(std::uint32_t key, std::uint32_t record, StageCounters& counters) {
  each_line(record, [&](std::size_t block, std::uint32_t first, std::uint32_t bytes) {
    l2_.write(key, block, first, bytes, counters);
  });
}

void LinearMemory::read(std::uint32_t key, std::uint32_t record, StageCounters& counters) {
  each_line(record, [&](std::size_t block, std::uint32_t first, std::uint32_t bytes) {
    l1_.read(key, block, first, bytes, counters);
  });
}

void LinearMemory::flush(StageCounters& counters) {
  l1_.flush(counters);
  l2_.flush(counters);
}

ABufferMemory::ABufferMemory(const MemoryParameters& parameters, const ZOrder& order, std::size_t records,
                             std::uint32_t record_bytes)
    : record_bytes_(record_bytes + kLinkBytes),
      heads_(parameters, order, 1, kLinkBytes, nullptr, BlockCache::Level::l2),
      records_(parameters, records, record_bytes_) {}

void ABufferMemory::insert(const std::vector<SortRecord>& records, StageCounters& counters) {
  for (std::uint32_t i = 0; i < records.size(); ++i) {
    heads_.access(records[i].triangle, records[i].pixel, 1, 1, counters);
    records_.write(records[i].triangle, i, counters);
  }
  heads_.flush(counters);
  records_.flush(counters);
  heads_.read_all(counters);
}

void ABufferMemory::sort(std::uint32_t pixel, const ABuffer& buffer, StageCounters& counters) {
  for (std::uint32_t i = buffer.first[pixel]; i < buffer.first[pixel + 1]; ++i)
    records_.read(pixel, buffer.records[i], counters);
}

void ABufferMemory::compose(std::uint32_t pixel, const ABuffer& buffer, std::uint32_t merged, StageCounters& counters) {
  for (std::uint32_t i = 0; i < merged; ++i) records_.read(pixel, buffer.records[buffer.first[pixel] + i], counters);
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

void count_triangle_fetches(const MemoryParameters& parameters, const Tile& tile, const TriangleList& list,
                            const ABuffer& buffer, const std::vector<SortRecord>& records,
                            const std::vector<float>& partial, StageCounters& fetching) {
  if (!parameters.modelled) return;
  const ZOrder order(tile.width(), tile.height());
  LinearMemory triangles(parameters, list.size(), sizeof(SetupTriangle));
  for_each_list(order, tile, buffer, [&](std::uint32_t pixel) {
    for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(partial[pixel]); ++i) {
      const std::uint32_t triangle = records[buffer.records[buffer.first[pixel] + i]].triangle;
      const auto place = std::lower_bound(list.begin(), list.end(), triangle) - list.begin();
      triangles.read(pixel, static_cast<std::uint32_t>(place), fetching);
    }
  });
  triangles.flush(fetching);
}

}  // namespace beampipe
