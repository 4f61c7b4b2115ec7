#include "pipeline/memory/tile_surface.h"

#include <bit>

namespace beampipe {
namespace {

std::uint32_t spread_bits(std::uint32_t x) {  // bit i to bit 2 i, of 16
  x = (x | x << 8) & 0x00ff00ffu;
  x = (x | x << 4) & 0x0f0f0f0fu;
  x = (x | x << 2) & 0x33333333u;
  return (x | x << 1) & 0x55555555u;
}

int log2_block_elements(const MemoryParameters& parameters, std::uint32_t element_bytes) {
  return std::bit_width(std::max(parameters.rop.line_bytes / element_bytes, 1u)) - 1;
}

std::size_t block_count(const MemoryParameters& parameters, const ZOrder& order, std::uint32_t element_bytes) {
  return ((order.positions - 1) >> log2_block_elements(parameters, element_bytes)) + 1;
}

}  // namespace

ZOrder::ZOrder(std::int32_t width, std::int32_t height) {
  of.reserve(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  for (std::int32_t y = 0; y < height; ++y) {
    for (std::int32_t x = 0; x < width; ++x) {
      of.push_back(spread_bits(static_cast<std::uint32_t>(x)) | spread_bits(static_cast<std::uint32_t>(y)) << 1);
      positions = std::max<std::size_t>(positions, of.back() + 1);
    }
  }
}

TileSurface::TileSurface(const MemoryParameters& parameters, const ZOrder& order, std::uint32_t element_bytes,
                         CompressedBytes compressed_bytes)
    : order_(order),
      element_bytes_(element_bytes),
      triangles_per_batch_(parameters.triangles_per_batch),
      log2_elements_per_block_(log2_block_elements(parameters, element_bytes)),
      touched_bytes_(parameters.modelled ? order.of.size() : 0),
      cache_(parameters, parameters.rop, block_count(parameters, order, element_bytes),
             element_bytes << log2_elements_per_block_, true,
             compressed_bytes
                 ? BlockCache::CompressedBytes([compressed_bytes, log2 = log2_elements_per_block_](std::size_t block) {
                     return compressed_bytes(block << log2, std::size_t{1} << log2);
                   })
                 : nullptr) {}

void TileSurface::access(std::uint32_t key, std::uint32_t element, std::uint32_t read, std::uint32_t write,
                         std::uint32_t part_bytes, StageCounters& counters) {
  if (touched_bytes_.empty()) return;  // nothing is modelled
  if (triangles_per_batch_ > 0 && key / triangles_per_batch_ != batch_) {
    cache_.flush(counters);
    batch_ = key / triangles_per_batch_;
  }
  touched_bytes_[element] += static_cast<std::uint32_t>(std::popcount(read) + std::popcount(write)) * part_bytes;
  const std::uint32_t position = order_.of[element], block = position >> log2_elements_per_block_;
  const std::uint32_t start = (position - (block << log2_elements_per_block_)) * element_bytes_;
  const auto each_run = [&](std::uint32_t parts, auto&& touch) {  // run by run of neighbouring parts
    while (parts != 0) {
      const auto first = static_cast<std::uint32_t>(std::countr_zero(parts));
      const auto count = static_cast<std::uint32_t>(std::countr_one(parts >> first));
      touch(start + first * part_bytes, count * part_bytes);
      parts &= first + count < 32 ? ~0u << (first + count) : 0u;
    }
  };
  each_run(read, [&](std::uint32_t first, std::uint32_t bytes) { cache_.read(key, block, first, bytes, counters); });
  each_run(write, [&](std::uint32_t first, std::uint32_t bytes) { cache_.write(key, block, first, bytes, counters); });
}

void TileSurface::read_all(StageCounters& counters) {
  if (touched_bytes_.empty()) return;
  flush(counters);
  std::vector<std::uint8_t> used(cache_.blocks());  // of a bin at the frame's border some hold no element
  for (const std::uint32_t position : order_.of) used[position >> log2_elements_per_block_] = 1;
  for (std::size_t block = 0; block < used.size(); ++block)
    if (used[block]) cache_.stream_read(block, counters);
}

}  // namespace beampipe
