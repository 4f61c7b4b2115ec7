#include "pipeline/memory/tile_surface.h"

#include <bit>

#include "simd/population_count.h"

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

// Indexed by element of a block, byte of the mask of parts, and value of that byte.
std::vector<Sectors> part_sectors(std::uint32_t elements, std::uint32_t parts, std::uint32_t part_bytes,
                                  int log2_sector) {
  std::vector<Sectors> table;
  for (std::uint32_t element = 0; element < elements; ++element) {
    for (std::uint32_t first = 0; first < parts; first += 8) {
      const std::size_t begin = table.size();
      table.resize(begin + 256);
      for (std::uint32_t part = first; part < std::min(first + 8, parts); ++part) {
        const Sectors sectors = sectors_of((element * parts + part) * part_bytes, part_bytes, log2_sector);
        const std::size_t masks = std::size_t{1} << (part - first);  // of the lower parts
        for (std::size_t mask = 0; mask < masks; ++mask) table[begin + masks + mask] = table[begin + mask] | sectors;
      }
    }
  }
  return table;
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

TileSurface::TileSurface(const MemorySystem& memory, std::string_view name, const ZOrder& order, std::uint32_t parts,
                         std::uint32_t part_bytes, CompressedBytes compressed_bytes, BlockCache::Level level)
    : order_(order),
      part_bytes_(part_bytes),
      element_bytes_(parts * part_bytes),
      mask_bytes_((parts + 7) / 8),
      log2_elements_per_block_(log2_block_elements(cache_of(memory, level), element_bytes_)),
      touched_bytes_(BlockCache::is_modelled(memory, level) ? order.of.size() : 0),
      cache_(memory, cache_of(memory, level), level, block_count(order, log2_elements_per_block_),
             element_bytes_ << log2_elements_per_block_, true,
             compressed_bytes
                 ? BlockCache::CompressedBytes([compressed_bytes, log2 = log2_elements_per_block_](std::size_t block) {
                     return compressed_bytes(block << log2, std::size_t{1} << log2);
                   })
                 : nullptr,
             BlockPlaces(memory, name, true)) {
  if (memory.reach) {
    const std::uint64_t bytes = std::uint64_t{cache_.blocks()} * cache_of(memory, level).line_bytes;
    memory.reach->add(level == BlockCache::Level::rop ? CacheReach{.rop = bytes} : CacheReach{.l2 = bytes});
  }
  if (!touched_bytes_.empty())
    part_sectors_ =
        part_sectors(1u << log2_elements_per_block_, parts, part_bytes, std::countr_zero(memory.sector_bytes));
}

void TileSurface::access(std::uint32_t key, std::uint32_t element, std::uint32_t read, std::uint32_t write,
                         StageCounters& counters) {
  if (touched_bytes_.empty()) return;  // there are no accesses to model
  touched_bytes_[element] += (population_count(read) + population_count(write)) * part_bytes_;
  const std::uint32_t position = order_.of[element], block = position >> log2_elements_per_block_;
  const std::uint32_t place = position - (block << log2_elements_per_block_);
  cache_.access(key, block, sectors_of_parts(place, read), sectors_of_parts(place, write), counters, [&](auto&& count) {
    for (std::uint32_t left = write; left != 0; left &= left - 1)
      count(place * element_bytes_ + static_cast<std::uint32_t>(std::countr_zero(left)) * part_bytes_, part_bytes_);
  });
}

void TileSurface::read_all(StageCounters& counters) {
  if (touched_bytes_.empty()) return;
  flush(counters);
  std::vector<std::uint8_t> used(cache_.blocks());  // at the frame's border some blocks hold no element
  for (const std::uint32_t position : order_.of) used[position >> log2_elements_per_block_] = 1;
  for (std::size_t block = 0; block < used.size(); ++block)
    if (used[block]) cache_.stream_read(block, counters);
}

}  // namespace beampipe
