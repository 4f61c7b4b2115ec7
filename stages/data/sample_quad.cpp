#include "stages/data/sample_quad.h"

namespace beampipe {

QuadFrame::QuadFrame(std::uint32_t width, std::uint32_t height)
    : columns(static_cast<std::int32_t>((width + 1) / 2)),
      rows(static_cast<std::int32_t>((height + 1) / 2)),
      quads(static_cast<std::size_t>(columns * rows)) {}

void QuadFrame::insert(const Tile& tile, const std::vector<SampleQuad>& of_tile) {
  const std::int32_t width = (tile.width() + 1) / 2;
  for (std::size_t i = 0; i < of_tile.size(); ++i) {
    const auto x = tile.x0 / 2 + static_cast<std::int32_t>(i) % width,
               y = tile.y0 / 2 + static_cast<std::int32_t>(i) / width;
    quads[static_cast<std::size_t>(y * columns + x)] = of_tile[i];
  }
}

std::vector<SampleQuad> QuadFrame::of(const Tile& tile) const {
  std::vector<SampleQuad> found;
  for (std::int32_t y = tile.y0 / 2; y < (tile.y1 + 1) / 2; ++y)
    for (std::int32_t x = tile.x0 / 2; x < (tile.x1 + 1) / 2; ++x)
      found.push_back(quads[static_cast<std::size_t>(y * columns + x)]);
  return found;
}

}  // namespace beampipe
