#include "pipeline/memory/framebuffer.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace beampipe {

std::uint32_t bytes_per_pixel(const std::vector<Surface>& surfaces) {
  std::uint32_t bytes = 0;
  for (const Surface& surface : surfaces) bytes += surface.bytes_per_pixel;
  return bytes;
}

std::string times(const char* format, std::uint32_t count) {
  return std::string(format).append(" x ").append(std::to_string(count));
}

Framebuffer Framebuffer::with_translucent() const {
  Framebuffer all = *this;
  all.surfaces.insert(all.surfaces.end(), translucent.begin(), translucent.end());
  all.translucent.clear();
  return all;
}

std::uint32_t Framebuffer::on_chip_bytes_per_pixel() const {
  std::uint32_t bytes = 0;
  for (const Surface& surface : surfaces) bytes += surface.outlives_bin ? 0 : surface.bytes_per_pixel;
  return bytes;
}

bool Framebuffer::wants_chip(const MemoryParameters& memory) const {
  return memory.framebuffer.value_or(place) == Place::on_chip;
}

int Framebuffer::bin_size_on(const MemoryParameters& memory) const {
  const int largest = std::min(bin_size, static_cast<int>(memory.bin_pixels));
  int side = largest;
  const auto has_room_for = [&](std::uint64_t bins) {
    const auto pixels = static_cast<std::uint64_t>(side) * static_cast<std::uint64_t>(side);
    return bins * pixels * on_chip_bytes_per_pixel() <= memory.on_chip_bytes;
  };
  while (wants_chip(memory) && side > kLeastBinSize && !has_room_for(memory.bins_per_core)) side /= 2;
  return has_room_for(1) ? side : largest;
}

bool Framebuffer::is_on_chip(const MemoryParameters& memory) const {
  const auto side = static_cast<std::uint64_t>(bin_size_on(memory));
  return wants_chip(memory) && on_chip_bytes_per_pixel() * side * side <= memory.on_chip_bytes;
}

std::uint64_t Framebuffer::bins_in_work(const MemoryParameters& memory) const {
  const double pixels = std::pow(bin_size_on(memory), 2);
  return memory.cores *
         std::uint64_t{memory.bins_held(is_on_chip(memory) ? pixels * on_chip_bytes_per_pixel() : 0, pixels)};
}

MemoryParameters Framebuffer::memory_of_bin(const MemoryParameters& memory, std::size_t bins) const {
  MemoryParameters of_bin = memory;
  of_bin.framebuffer = is_on_chip(memory) ? Place::on_chip : Place::in_memory;
  if (!finds_no_room(memory)) return of_bin;
  const std::uint64_t sharing = std::clamp<std::uint64_t>(bins, 1, bins_in_work(memory));
  const std::uint64_t least = std::uint64_t{memory.rop.ways} * memory.rop.line_bytes;
  of_bin.rop.bytes = static_cast<std::uint32_t>(std::max(memory.rop.bytes / sharing, least));
  return of_bin;
}

std::vector<Surface> Framebuffer::in_memory(const MemoryParameters& memory) const {
  if (!is_on_chip(memory)) return surfaces;
  std::vector<Surface> kept;
  std::copy_if(surfaces.begin(), surfaces.end(), std::back_inserter(kept),
               [](const Surface& surface) { return surface.outlives_bin; });
  const bool has_picture =
      std::any_of(kept.begin(), kept.end(), [](const Surface& surface) { return surface.name == "color"; });
  if (!has_picture) kept.push_back({"color", "RGB16F", kPictureBytes});
  return kept;
}

}  // namespace beampipe
