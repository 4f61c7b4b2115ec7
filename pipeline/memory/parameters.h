// Every parameter of the modelled memory system, with its source.
//
// What is modelled: the surfaces of one bin (a scheduling tile) at a time, as a binning rasterizer draws them: all
// triangles of the bin in order, then the next bin. A cache per surface class, empty at the start of a bin; at the end
// of each pass over the frame, what is dirty is written back, since the next pass starts with another bin. What a
// stage asks for and its cache holds stays there; L2 is asked for what that cache lacks or evicts, DRAM for what L2
// does.
// What passes between stages is taken to stay in queues on chip: it is in the logical bytes and in neither of the
// others.
#pragma once

#include <algorithm>
#include <cstdint>

namespace beampipe {

// Set-associative, least recently used, write-back. A line holds one block of a surface, whole sectors of it at a time.
struct CacheParameters {
  std::uint32_t bytes, ways, line_bytes;
  bool operator==(const CacheParameters&) const = default;
};

struct MemoryParameters {
  bool modelled = true;  // false: sectors and DRAM bytes stay 0, and frames are faster to simulate

  // What is moved at once, in every cache and to and from DRAM. Source: L2 and DRAM granule of NVIDIA GPUs since
  // Kepler, as GPGPU-Sim models it (configs/tested-cfgs: sector caches, 4 sectors of 32 bytes to a 128-byte line).
  static constexpr std::uint32_t sector_bytes = 32;

  // Depth, colour and every other framebuffer surface: one cache for each. Source: ATTILA (test/config/bGPU.ini):
  // 4 ways, 16 lines per way, 16 stamps of 4 pixels of 4 bytes to a line, which is 256 bytes: 16 KiB in each ROP unit,
  // which does a 2x2 quad per clock. A Titan V has 96 ROPs (TechPowerUp): 24 such units.
  CacheParameters rop{24 * 16 * 1024, 4, 256};

  // What shaders read goes through the L1 of the multiprocessor that works on the bin; what they write goes past it.
  // Source: GPGPU-Sim's Volta: 4 sets of 64 lines, write-through. (With what is not used as shared memory it grows to
  // 128 KiB.)
  CacheParameters l1{32 * 1024, 64, 128};

  // Behind it, for what shaders read and write: the A-buffer, setup triangles. Source: GPGPU-Sim's Volta: 32 sets of 24
  // lines of 128 bytes in each slice, 96 KiB; 48 slices make a Titan V's 4.5 MiB (NVIDIA's figure).
  CacheParameters l2{48 * 96 * 1024, 24, 128};

  // Block states cleared, compressed and raw; without compression, cleared and raw. Clearing a surface sets states,
  // which are kept on chip (ATTILA: block state memory), and moves nothing.
  bool compression = true;

  // Compressed depth: a plane of 3 x float32 for each triangle in the block, and for each sample the number of its
  // plane in as many bits as that takes. Source: Hasselgren and Akenine-Moller 2006, "Efficient Depth Buffer
  // Compression", plane encoding.
  std::uint32_t plane_bytes = 12;

  bool operator==(const MemoryParameters&) const = default;
};

// Pixels on each side of a bin: 32, or less so that it has at most 2^16 samples. Source: NVIDIA at GDC 2017, as
// TechPowerUp reports: "16x16 and 32x32 pixels are the usual tile sizes", chosen by what a pixel takes.
inline constexpr int kBinSize = 32;

inline constexpr int bin_size(int samples_per_pixel) {
  int size = kBinSize;
  while (size > 2 && size * size * samples_per_pixel > 1 << 16) size /= 2;
  return size;
}

}  // namespace beampipe
