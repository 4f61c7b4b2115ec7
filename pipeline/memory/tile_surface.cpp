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

const CacheParameters& cache_of(const MemoryParameters& parameters, BlockCache::Level level) {
  return level == BlockCache::Level::rop ? parameters.rop : parameters.l2;
}

int log2_block_elements(const CacheParameters& cache, std::uint32_t element_bytes) {
  return std::bit_width(std::max(cache.line_bytes / element_bytes, 1u)) - 1;
}

std::size_t block_count(const ZOrder& order, int log2_elements) { return ((order.positions - 1) >> log2_elements) + 1; }

BlockCache::CompressedBytes of_blocks(const TileSurface::CompressedBytes& compressed_bytes, int log2_elements) {
  if (!compressed_bytes) return {};
  return [=](std::size_t block) { return compressed_bytes(block << log2_elements, std::size_t{1} << log2_elements); };
}

}  // namespace

ZOrder::ZOrder(std::int32_t width, std::int32_t height) {
  of.reserve(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  std::vector<std::uint32_t> columns;
  for (std::int32_t x = 0; x < width; ++x) columns.push_back(spread_bits(static_cast<std::uint32_t>(x)));
  for (std::int32_t y = 0; y < height; ++y) {
    const std::uint32_t row = spread_bits(static_cast<std::uint32_t>(y)) << 1;
    for (const std::uint32_t column : columns) of.push_back(row | column);
  }
  if (!of.empty()) positions = std::size_t{of.back()} + 1;
}

std::vector<TileSurface::Parts> TileSurface::part_table(std::uint32_t elements, std::uint32_t parts,
                                                        std::uint32_t part_bytes, int log2_sector) {
  std::vector<Parts> table;
  for (std::uint32_t element = 0; element < elements; ++element) {
    for (std::uint32_t first = 0; first < parts; first += kMaskBits) {
      const std::size_t begin = table.size();
      table.resize(begin + (1 << kMaskBits));
      for (std::uint32_t part = first; part < std::min(first + kMaskBits, parts); ++part) {
        const Parts one{sectors_of((element * parts + part) * part_bytes, part_bytes, log2_sector), 1};
        const std::size_t masks = std::size_t{1} << (part - first);  // of the lower parts
        for (std::size_t mask = 0; mask < masks; ++mask) table[begin + masks + mask] = table[begin + mask] + one;
      }
    }
  }
  return table;
}

TileSurface::TileSurface(const MemorySystem& memory, std::string_view name, const ZOrder& order, const Element& element,
                         BlockCache::Level level)
    : order_(order),
      part_bytes_(element.part_bytes),
      element_bytes_(element.parts * element.part_bytes),
      mask_bytes_((element.parts + 7) / 8),
      log2_elements_per_block_(log2_block_elements(cache_of(memory, level), element_bytes_)),
      touched_parts_(BlockCache::is_modelled(memory, level) ? order.positions : 0),
      cache_(memory, cache_of(memory, level), level,
             {.count = block_count(order, log2_elements_per_block_),
              .bytes = element_bytes_ << log2_elements_per_block_,
              .cleared = true,
              .compressed_bytes = of_blocks(element.compressed_bytes, log2_elements_per_block_),
              .places = BlockPlaces(memory, name, true)}) {
  if (memory.reach) {
    const std::uint64_t bytes = std::uint64_t{cache_.blocks()} * cache_of(memory, level).line_bytes;
    memory.reach->add(level == BlockCache::Level::rop ? CacheReach{.rop = bytes} : CacheReach{.l2 = bytes});
  }
  if (!touched_parts_.empty())
    part_table_ =
        part_table(1u << log2_elements_per_block_, element.parts, part_bytes_, std::countr_zero(memory.sector_bytes));
}

void TileSurface::read_all(StageCounters& counters) {
  if (touched_parts_.empty()) return;
  flush(counters);
  std::vector<std::uint8_t> used(cache_.blocks());  // at the frame's border some blocks hold no element
  for (const std::uint32_t position : order_.of) used[position >> log2_elements_per_block_] = 1;
  for (std::size_t block = 0; block < used.size(); ++block)
    if (used[block]) cache_.stream_read(block, counters);
}

}  // namespace beampipe
