// A sample fragment: a triangle's samples in one cell. Sample fragments go from sample_raster to the depth test.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <optional>

#include "simd/sample_pattern.h"
#include "stages/data/pair.h"
#include "stages/data/setup_triangle.h"
#include "stages/data/tile.h"

namespace beampipe {

// Cells per pixel in x and y: powers of two up to 16. A cell is a pixel, or a part of one if pixels are super-resolved.
struct CellGrid {
  std::int32_t columns = 1, rows = 1;

  std::int32_t cell_width() const { return kSubpixelUnits / columns; }  // 1/256 px
  std::int32_t cell_height() const { return kSubpixelUnits / rows; }
  std::int32_t cells_per_pixel() const { return columns * rows; }
  // What a shader of a cell sees: its longer side, in pixels.
  float shading_width() const { return 1.0f / static_cast<float>(std::min(columns, rows)); }
  // The pixel that a cell lies in, and the cell's number within that pixel, row by row.
  std::int32_t pixel_x(std::int32_t x) const { return x >> std::countr_zero(static_cast<std::uint32_t>(columns)); }
  std::int32_t pixel_y(std::int32_t y) const { return y >> std::countr_zero(static_cast<std::uint32_t>(rows)); }
  std::int32_t in_pixel(std::int32_t x, std::int32_t y) const {
    return (y & (rows - 1)) * columns + (x & (columns - 1));
  }
  bool operator==(const CellGrid&) const = default;
};

// How a pixel is sampled: a grid of cells, each with the pattern's positions (already scaled to the cell).
struct Sampling {
  CellGrid grid;
  SamplePattern pattern;
};

// Triangles, and how a tile samples them.
struct SampledTriangles {
  const SetupTriangles& triangles;
  const Tile& tile;
  const Sampling& sampling;
};

// The tile measured in cells instead of pixels.
inline Tile cells_of(const Tile& tile, const CellGrid& grid) {
  return {tile.x0 * grid.columns, tile.y0 * grid.rows, tile.x1 * grid.columns, tile.y1 * grid.rows};
}

struct SampleFragment {
  std::uint32_t triangle;           // index into SetupTriangles
  std::uint32_t quad;               // the same number for all cells of one triangle in one 2x2 quad
  std::int32_t x, y;                // cell, frame coordinates
  std::uint32_t mask;               // bit s: the triangle covers sample s of the pattern; not 0
  std::optional<float> depth = {};  // of all samples, in place of the triangle's: -1..0
};

// The fragment's cell in the tile: pixel (row by row) x cells per pixel + cell within the pixel.
inline std::uint32_t cell_number(const SampleFragment& fragment, const Tile& tile, const CellGrid& grid) {
  const std::size_t pixel = tile.index(grid.pixel_x(fragment.x), grid.pixel_y(fragment.y));
  return static_cast<std::uint32_t>(pixel) * static_cast<std::uint32_t>(grid.cells_per_pixel()) +
         static_cast<std::uint32_t>(grid.in_pixel(fragment.x, fragment.y));
}

// Size in the modelled machine: a pair with a 16-bit coverage mask.
inline constexpr std::uint64_t kSampleFragmentBytes = kPairBytes + 2;

// Fragments of a quad follow each other.
template <class Fragments>
bool starts_quad(const Fragments& fragments, std::size_t i) {
  return i == 0 || fragments[i].quad != fragments[i - 1].quad;
}

}  // namespace beampipe
