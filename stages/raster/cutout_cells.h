// Where in the pixels of a tile a cutout is there, for many samples at once: in a whole pixel, in a 16th of it, or in a
// cell of samples. Only where that is open, alpha has to be tested at each sample.
#pragma once

#include <cstdint>
#include <vector>

#include "stages/data/tile.h"
#include "stages/surface/surface_shader.h"

namespace beampipe {

class CutoutCells {
 public:
  // `cells`: per pixel in x and y, a multiple of 4. The shader must outlive it.
  CutoutCells(const TileShader& shader, const Tile& tile, std::int32_t cells);

  // Of the cutout to which the questions that follow belong.
  void start(std::uint32_t triangle);

  // What the alpha test says for every point of a pixel, or of a cell, that lies in the triangle.
  CutoutCover of_pixel(std::uint32_t pixel) {
    CutoutCover& cover = pixels_[pixel];
    if (cover == CutoutCover::unknown) find(cover, pixel, 0, 0, 1);
    return cover;
  }
  CutoutCover of_cell(std::uint32_t pixel, std::int32_t column, std::int32_t row) {
    const CutoutCover cover = of_pixel(pixel);
    if (cover != CutoutCover::mixed) return cover;
    const std::int32_t part_x = column / (cells_ / kParts), part_y = row / (cells_ / kParts);
    CutoutCover& of_part =
        parts_[(pixel * kParts + static_cast<std::uint32_t>(part_y)) * kParts + static_cast<std::uint32_t>(part_x)];
    if (of_part == CutoutCover::unknown) find(of_part, pixel, part_x, part_y, kParts);
    if (of_part != CutoutCover::mixed) return of_part;
    const auto across = static_cast<std::uint32_t>(cells_);
    CutoutCover& cell =
        squares_[(pixel * across + static_cast<std::uint32_t>(row)) * across + static_cast<std::uint32_t>(column)];
    if (cell == CutoutCover::unknown) find(cell, pixel, column, row, cells_);
    return cell;
  }

 private:
  static constexpr std::int32_t kParts = 4;  // in x and y

  // Of a square: one of `count` x `count` in the pixel.
  void find(CutoutCover& cover, std::uint32_t pixel, std::int32_t column, std::int32_t row, std::int32_t count) const;

  const TileShader& shader_;
  std::int32_t cells_;
  std::uint32_t triangle_ = 0;
  std::vector<CutoutCover> pixels_, parts_, squares_;
};

}  // namespace beampipe
