// sample_raster: setup triangles -> (cell, triangle, sample mask). Exact, with the top-left rule: a sample on an edge
// that two triangles share belongs to one of them.
#pragma once

#include <cstdint>
#include <vector>

#include "simd/sample_pattern.h"
#include "stages/cost/counters.h"
#include "stages/data/closed_depth.h"
#include "stages/data/setup_triangle.h"
#include "stages/data/tile.h"
#include "stages/raster/traverse.h"

namespace beampipe {

// A triangle's samples in one cell; at least one.
struct SampleFragment {
  std::uint32_t triangle;  // index into SetupTriangles
  std::uint32_t quad;      // cells of one triangle in one 2x2 quad share it
  std::int32_t x, y;       // cell, frame coordinates
  std::uint32_t mask;      // bit s: sample s of the pattern
};

// How a pixel is sampled: a grid of cells, each with the pattern's positions (already scaled to the cell).
struct Sampling {
  CellGrid grid;
  SamplePattern pattern;
};

// The tile in cells: what has a value for each of them.
inline Tile cells_of(const Tile& tile, const CellGrid& grid) {
  return {tile.x0 * grid.columns, tile.y0 * grid.rows, tile.x1 * grid.columns, tile.y1 * grid.rows};
}

// Appends to `out`, triangle by triangle in the list's order. With `closed`, of cells_of(tile), a triangle is left out
// of cells that earlier ones, of this list or of those before, cover as a whole and in front of all its vertices: no
// sample would pass its depth test there.
void sample_raster(const SetupTriangles& triangles, const TriangleList& list, const Tile& tile,
                   const Sampling& sampling, StageCounters& counters, std::vector<SampleFragment>& out,
                   ClosedDepth* closed = nullptr);

}  // namespace beampipe
