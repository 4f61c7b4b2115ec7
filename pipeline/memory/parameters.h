// Every parameter of the modelled memory system, with its source.
//
// The model follows a binning rasterizer, which draws all triangles of one bin in order and then goes on to the next
// bin; without bins the frame is the only one. Every class of surface has a cache, which is empty at the start of a
// bin. At the end of each pass over the frame
// dirty lines are written back, because the next pass starts with another bin. Requests that hit their cache go no
// further; misses and evictions go to L2, and those of L2 go to DRAM. Data that passes from stage to stage stays in
// queues on chip: it counts as logical bytes only. Textures are what bins share, so L2 keeps texels from bin to bin.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <optional>

namespace beampipe {

// A set-associative write-back cache that replaces the least recently used line. A line holds one block of a surface,
// sector by sector. It has as many sets as fit, and at least one.
struct CacheParameters {
  std::uint32_t bytes, ways, line_bytes;

  std::uint32_t sets() const { return std::max(bytes / (line_bytes * ways), 1u); }
  std::uint64_t held_bytes() const { return std::uint64_t{sets()} * ways * line_bytes; }
  bool operator==(const CacheParameters&) const = default;
};

// The most bytes of memory that any one cache of each kind stands before. A cache that holds as many never evicts
// anything, so that another one that holds as many moves the same bytes.
struct CacheReach {
  std::uint64_t rop = 0, l1 = 0, l2 = 0;

  void add(const CacheReach& other) {
    rop = std::max(rop, other.rop), l1 = std::max(l1, other.l1), l2 = std::max(l2, other.l2);
  }
  bool operator==(const CacheReach&) const = default;
};

// Where the pixels of a bin are kept while it is drawn: on chip, as in tile-based rendering, so that only the finished
// picture goes to memory; or in the framebuffer in memory, behind caches.
enum class Place { on_chip, in_memory };

// As on the command line and in reports.
inline constexpr const char* kByTechnique = "by-technique";
inline constexpr const char* kOnChip = "on-chip";
inline constexpr const char* kInMemory = "in-memory";
constexpr const char* name_of(std::optional<Place> place) {
  return !place ? kByTechnique : *place == Place::on_chip ? kOnChip : kInMemory;
}

inline constexpr std::uint32_t kPictureBytes = 6;  // per pixel of a finished picture: fp16 RGB

// Pixels on each side of a bin: 32, or fewer so that a bin has at most 2^16 samples. Source: NVIDIA at GDC 2017, as
// TechPowerUp reports: "16x16 and 32x32 pixels are the usual tile sizes", chosen by what a pixel takes.
inline constexpr int kBinSize = 32;

// Bins are not made smaller than that to fit on chip. Apple's and Arm's GPUs go no further than a quarter of their
// usual tiles of 32 x 32 and 16 x 16 pixels.
inline constexpr int kLeastBinSize = 8;

// The smallest sector, and that of the textures' layout.
inline constexpr std::uint32_t kLeastSectorBytes = 32;

struct MemoryParameters {
  bool modelled = true;  // false: sectors and DRAM bytes stay 0, and frames are faster to simulate

  // The unit that moves, in every cache and to and from DRAM: a power of two, at least kLeastSectorBytes. A line has 1
  // to 8 sectors. Source: the L2 and DRAM granule of NVIDIA GPUs since Kepler, as GPGPU-Sim models it
  // (configs/tested-cfgs: sector caches, 4 sectors of 32 bytes to a 128-byte line).
  std::uint32_t sector_bytes = kLeastSectorBytes;

  // One cache each for depth, colour and every other framebuffer surface. Source: ATTILA (test/config/bGPU.ini):
  // 4 ways, 16 lines per way, 16 stamps of 4 pixels of 4 bytes to a line, which is 256 bytes: 16 KiB in each ROP unit,
  // which does a 2x2 quad per clock. A Titan V has 96 ROPs (TechPowerUp): 24 such units.
  CacheParameters rop{24 * 16 * 1024, 4, 256};

  // Shaders read through the L1 of the multiprocessor that works on the bin; their writes bypass it. Source:
  // GPGPU-Sim's Volta: 4 sets of 64 lines, write-through. (It can grow to 128 KiB where shared memory leaves room.) It
  // is the texture cache as well (Volta whitepaper: L1 data cache, texture cache and shared memory are one).
  CacheParameters l1{32 * 1024, 64, 128};

  // The L2 for shader reads and writes, such as the A-buffer, setup triangles and texels. Source: GPGPU-Sim's Volta: 32
  // sets of 24 lines of 128 bytes in each slice, 96 KiB; 48 slices make a Titan V's 4.5 MiB (NVIDIA's figure). Its
  // lines are as long as those of L1.
  CacheParameters l2{48 * 96 * 1024, 24, 128};

  // With compression a block is cleared, compressed or raw; without it, cleared or raw. Clearing a surface only sets
  // the blocks' states, which are kept on chip (ATTILA: block state memory), and moves nothing.
  bool compression = true;

  // A compressed depth block has one plane of 3 x float32 per triangle in the block, and for each sample the number of
  // its plane in as few bits as possible. Source: Hasselgren and Akenine-Moller 2006, "Efficient Depth Buffer
  // Compression", plane encoding.
  std::uint32_t plane_bytes = 12;

  // Where every technique keeps its pixels; nothing: each on the machine that it is made for (Framebuffer::place).
  std::optional<Place> framebuffer;

  // The memory that a core has on chip for the pixels of bins, how many bins it works on at a time, and how many cores
  // there are. Where pixels are on chip, bins are made so small that as many fit (Framebuffer::bin_size_on). Source: 96
  // KB of shared memory in each of the 80 multiprocessors of a Titan V (Volta whitepaper). Two bins are a choice: one
  // is composed while the next one is fetched.
  std::uint32_t on_chip_bytes = 96 * 1024, bins_per_core = 2, cores = 80;

  // Are triangles sorted into bins? If not, each goes from setup to the raster on chip and is drawn over the whole
  // frame before the next one, and none is looked at again in that pass. Only some techniques can do that
  // (Framebuffer::needs_bins).
  bool binned = true;

  // The most pixels on each side of a bin, at most kBinSize. Techniques whose bins are smaller keep them.
  std::uint32_t bin_pixels = kBinSize;

  bool draws_unbinned() const { return modelled && !binned; }
  bool stores_triangles() const { return modelled && binned; }

  // The most bins of so many pixels that a core works on at a time: `bins_per_core` of 32 x 32, and of smaller ones as
  // many as have the same number of pixels. 0 pixels: the size is not known.
  std::uint32_t most_bins(double pixels) const {
    constexpr double kPixels = kBinSize * kBinSize;
    return static_cast<std::uint32_t>(bins_per_core * std::max(kPixels / (pixels > 0 ? pixels : kPixels), 1.0));
  }

  // How many bins a core holds: as many of these as it has room for, and at least one. `bytes`: what the pixels of a
  // bin take on chip.
  std::uint32_t bins_held(double bytes, double pixels) const {
    const double room = std::max(on_chip_bytes / std::max(bytes, 1.0), 1.0);
    return static_cast<std::uint32_t>(std::min(room, static_cast<double>(most_bins(pixels))));
  }

  // That hold so many bytes in a row.
  std::uint64_t sectors(std::uint64_t bytes) const {
    return (bytes + sector_bytes - 1) >> std::countr_zero(sector_bytes);
  }
  std::uint32_t sectors_per_line() const { return l2.line_bytes / sector_bytes; }  // of L1 and L2

  // Are there accesses to the framebuffer in memory to model?
  bool models_framebuffer() const { return modelled && framebuffer != Place::on_chip; }

  bool operator==(const MemoryParameters&) const = default;
};

inline constexpr int bin_size(int samples_per_pixel) {
  int size = kBinSize;
  while (size > 2 && size * size * samples_per_pixel > 1 << 16) size /= 2;
  return size;
}

}  // namespace beampipe
