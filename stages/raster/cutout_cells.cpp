#include "stages/raster/cutout_cells.h"

#include <algorithm>

namespace beampipe {

CutoutCells::CutoutCells(const TileShader& shader, const Tile& tile, std::int32_t cells)
    : shader_(shader),
      cells_(cells),
      pixels_(tile.pixels()),
      parts_(tile.pixels() * kParts * kParts),
      squares_(tile.pixels() * static_cast<std::size_t>(cells * cells)) {}

void CutoutCells::start(std::uint32_t triangle) {
  triangle_ = triangle;
  for (std::vector<CutoutCover>* const covers : {&pixels_, &parts_, &squares_})
    std::ranges::fill(*covers, CutoutCover::unknown);
}

void CutoutCells::find(CutoutCover& cover, std::uint32_t pixel, std::int32_t column, std::int32_t row,
                       std::int32_t count) const {
  const float side = 1.0f / static_cast<float>(count);
  cover =
      shader_.cutout_cover(triangle_, pixel, static_cast<float>(column) * side, static_cast<float>(row) * side, side);
}

}  // namespace beampipe
