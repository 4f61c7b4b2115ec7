// reference_raster: setup triangles -> the nearest triangle at each of 4096 samples per pixel.
//
// The truth that every technique is judged against, on the same snapped triangles: spans per sample row by exact
// integer division (a path of its own beside sample_raster's edge tests), depth in double precision, LESS.
//
// A pixel has 256 rows of 16 samples; each row is shifted by its bit-reversed number, so that all 4096 samples have
// different x. Vertical and horizontal edges at 1/256 px then get their exact area, which a regular 64 x 64 grid misses
// by up to 1/128 px, and misses together with every pattern that shares its columns (8x super-resolved to 256x does).
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "stages/cost/counters.h"
#include "stages/data/setup_triangle.h"
#include "stages/data/tile.h"

namespace beampipe {

inline constexpr std::int32_t kReferenceRows = 256;    // sample rows per pixel
inline constexpr std::int32_t kReferenceColumns = 16;  // samples per row and pixel
inline constexpr std::int32_t kReferenceSamples = kReferenceRows * kReferenceColumns;
inline constexpr std::uint64_t kNoOwner = ~std::uint64_t{0};

// Sample rows from top to bottom over the whole tile.
struct ReferenceTile {
  std::vector<double> depth;
  std::vector<std::uint64_t> owner;  // index into SetupTriangles, or kNoOwner
  std::size_t row_samples = 0;

  explicit ReferenceTile(const Tile& tile);
};

void reference_raster(const SetupTriangles& triangles, const TriangleList& list, const Tile& tile,
                      StageCounters& counters, ReferenceTile& surface);

// Mean of each pixel's samples, summed in double.
std::vector<glm::vec4> resolve(const ReferenceTile& surface, const Tile& tile, const std::vector<glm::vec3>& colors,
                               const glm::vec3& background, StageCounters& counters);

}  // namespace beampipe
