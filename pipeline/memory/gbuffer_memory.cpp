#include "pipeline/memory/gbuffer_memory.h"

#include "pipeline/memory/image_memory.h"
#include "stages/picture/shade.h"

namespace beampipe {

std::vector<std::uint32_t> shown_pixels(const SampleTile& surface, const Tile& tile) {
  std::vector<std::uint32_t> pixels;
  for (std::uint32_t pixel = 0; pixel < tile.pixels(); ++pixel)
    if (surface.triangle[pixel] != kNoTriangle) pixels.push_back(pixel);
  return pixels;
}

void write_pixels(const std::vector<std::uint32_t>& pixels, TileSurface& to, StageCounters& counters) {
  for (const std::uint32_t pixel : pixels) to.write(0, pixel, counters);
  to.flush(counters);
}

void move_light_and_resolve(const MemoryParameters& memory, const Tile& tile, const ZOrder& order,
                            const std::vector<std::uint32_t>& pixels, TileSurface& gbuffer, StageCounters& lighting,
                            StageCounters& resolving, std::vector<float>& bytes) {
  TileSurface color(memory, order, 1, kSampleColorBytes);
  gbuffer.read_all(lighting);
  write_pixels(pixels, color, lighting);
  color.read_all(resolving);
  write_image(memory, tile, resolving);
  gbuffer.add_bytes(bytes);
  color.add_bytes(bytes);
}

}  // namespace beampipe
