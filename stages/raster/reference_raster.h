// reference_raster: setup triangles -> the nearest triangle at each of 4096 samples per pixel, or 16,384.
//
// This is the reference that every technique is compared with, on the same snapped triangles. It computes the span of
// samples that a triangle covers in each sample row by exact integer division, independently of the edge tests of
// sample_raster. Depth is in double precision, and the depth test is LESS.
//
// A pixel has 256 rows of 16 samples. Each row is shifted by its bit-reversed number, so all 4096 samples have
// different x. Vertical and horizontal edges at multiples of 1/256 px therefore get their exact area. A regular 64 x 64
// grid would be wrong by up to 1/128 px, and so would every pattern that shares its columns (8x super-resolved to 256x
// does).
//
// Other sets measure the error of this one. Their shifts are scrambled as in A. B. Owen: Randomly Permuted (t,m,s)-Nets
// and (t,s)-Sequences, 1995, which keeps what is said above, and a sample lies anywhere between its row's borders.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "stages/cost/counters.h"
#include "stages/data/setup_triangle.h"
#include "stages/data/tile.h"
#include "stages/surface/surface_shader.h"

namespace beampipe {

// Where the samples of a pixel are.
struct ReferencePattern {
  std::int32_t columns = 16;  // samples per row and pixel: 16 or 32
  int set = 1;                // 1: bit-reversed numbers; others, up to 4, are scrambled

  std::int32_t rows() const { return 16 * columns; }  // per pixel
  std::int32_t samples() const { return columns * rows(); }
  std::int32_t units() const { return 2 * samples(); }  // of positions, per pixel

  // The place of a row's first sample in the pixel, in these units. `row` counts from the top of any pixel.
  struct Place {
    std::int64_t x, y;
  };
  Place first_in_row(std::int64_t row) const;
};

// An owner that is no triangle: the background, or that whose colour ReferenceTile::color has.
inline constexpr std::uint64_t kNoOwner = ~std::uint64_t{0}, kColoredOwner = kNoOwner - 1;

// The samples of a tile: sample rows from top to bottom, each across the whole tile.
struct ReferenceTile {
  std::vector<double> depth;
  std::vector<std::uint64_t> owner;  // index into SetupTriangles, or one of the above
  std::size_t row_samples = 0;

  // A translucent triangle at a sample.
  struct Layer {
    std::uint32_t sample;    // index into `owner`
    std::uint32_t triangle;  // index into SetupTriangles
    double depth;
  };
  std::vector<Layer> layers;  // in primitive order; some may lie behind the owner
  ReferencePattern pattern;

  // In the API's order (stages/raster/ordered_reference.h); else empty. A cell has one column and 16 rows, and the
  // number of its rows times row_samples plus its column.
  std::vector<glm::vec4> color;  // RGBA of samples that are kColoredOwner
  std::vector<std::uint8_t> stencil;
  std::vector<bool> is_uniform;  // of cells: is the colour of the first sample that of all?

  explicit ReferenceTile(const Tile& tile, const ReferencePattern& pattern = {});
};

// What is drawn into a tile, in this order.
struct ListedTriangles {
  const SetupTriangles& triangles;
  const TriangleList& list;
  const Tile& tile;
};

// Counts as items out the samples at which a triangle is nearer than all earlier ones.
// Alpha is tested at every sample. `shader` may be null if all triangles are opaque.
void reference_raster(const ListedTriangles& drawn, StageCounters& counters, ReferenceTile& surface,
                      const TileShader* shader = nullptr);

// For each pixel of the tile, the layers that lie in front of the owners of their samples: sorted by sample, and from
// near to far. Layers of equal depth stay in primitive order.
std::vector<std::vector<ReferenceTile::Layer>> layers_of_pixels(const ReferenceTile& surface, const Tile& tile);

// Surfaces that vary are shaded 256 times per pixel, or 1024 times: in each of 16 x 16 cells of 16 samples, each
// triangle once for its samples there, at their mean position, with the part of its textures that the cell covers.
// Translucent layers are composed at every sample, sorted by depth.
//
// Returns the mean of each pixel's samples, summed in double precision: RGBA per pixel of the tile.
std::vector<glm::vec4> resolve(const ReferenceTile& surface, const Tile& tile, const TileShader& shader,
                               const glm::vec3& background, StageCounters& counters);

}  // namespace beampipe
