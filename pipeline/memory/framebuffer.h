// What a technique stores for each pixel while its bin is drawn, and where: in memory, behind caches, or on chip.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "pipeline/memory/parameters.h"

namespace beampipe {

// One surface of the modelled framebuffer. Its bytes per pixel are those of the named format.
struct Surface {
  std::string name;    // "depth", "color", "mask", ...
  std::string format;  // "D32F x 8", "RGB16F", ...
  std::uint32_t bytes_per_pixel = 0;
  bool outlives_bin = false;  // in memory on every machine, because other bins or later frames read it
};

// The name of the buffer that holds the pixels of a bin where they are on chip.
inline constexpr const char* kOpenPixels = "open_pixels";

// The name of the buffer that says what a frame's translucent triangles take in memory beside the framebuffer.
inline constexpr const char* kTranslucentLayer = "translucent_layer";

// Records of pixels in memory that found no room in their bins' pools, of all bins in work at the same time.
inline constexpr const char* kSpilledRecords = "spilled_records";

struct Framebuffer {
  std::vector<Surface> surfaces = {};
  // More of them, in frames with translucent triangles.
  std::vector<Surface> translucent = {};
  Place place = Place::in_memory;  // on the machine that the technique is made for
  int bin_size = kBinSize;         // the technique's pixels on each side of a bin, even
  bool needs_bins = true;          // else each triangle may be drawn over the whole frame before the next one

  // That, or those of the memory system if they are smaller. Where pixels are on chip, half of that, and so on, until
  // as many bins fit as a core works on at a time, or bins are as small as they may be. If not even one of these fits,
  // pixels are in memory, and bins are not made smaller.
  int bin_size_on(const MemoryParameters& memory) const;

  // On all cores, at the same time.
  std::uint64_t bins_in_work(const MemoryParameters& memory) const;

  // With all surfaces of a frame with translucent triangles.
  Framebuffer with_translucent() const;

  // Are the pixels of a bin on chip while it is drawn? Only if all that the pixels of one bin store fits there.
  bool is_on_chip(const MemoryParameters& memory) const;

  // Should the pixels be on chip, although not even one bin fits?
  bool finds_no_room(const MemoryParameters& memory) const { return wants_chip(memory) && !is_on_chip(memory); }

  // What one of the frame's `bins` has of the memory system: its pixels' place, and the caches of ROPs. These are those
  // of the GPU, which draws one bin after the other if it keeps pixels in memory; but where pixels find no room, cores
  // draw several bins at the same time, and share these caches among them.
  MemoryParameters memory_of_bin(const MemoryParameters& memory, std::size_t bins) const;

  // The surfaces that are in memory: all of them, or, where pixels are on chip, the picture and what outlives the bin.
  std::vector<Surface> in_memory(const MemoryParameters& memory) const;

  // What a pixel takes on chip where pixels are on chip.
  std::uint32_t on_chip_bytes_per_pixel() const;

 private:
  bool wants_chip(const MemoryParameters& memory) const;
};

std::uint32_t bytes_per_pixel(const std::vector<Surface>& surfaces);

// "D32F x 8": the format of a surface that has `count` values per pixel.
std::string times(const char* format, std::uint32_t count);

}  // namespace beampipe
