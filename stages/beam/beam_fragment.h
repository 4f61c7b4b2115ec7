// beam_fragment: (pixel, triangle) -> fragment. Analytic coverage of the clipped triangle, localization mask, depth
// plane, depth range, centroid: everything about the triangle's visibility in the pixel.
#pragma once

#include <algorithm>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "simd/coverage.h"
#include "simd/depth_range.h"
#include "simd/mask_table.h"
#include "simd/merge.h"
#include "simd/position_mask.h"
#include "simd/sample_mask.h"
#include "simd/wide_mask.h"
#include "stages/raster/conservative_raster.h"
#include "stages/raster/raster_cost.h"

namespace beampipe {

struct Fragment {
  std::uint32_t triangle;        // index into SetupTriangles
  std::uint32_t quad;            // as in PixelTriangle
  std::uint32_t pixel;           // within the tile, row by row
  bool front;                    // as in SetupTriangle
  bool tiny;                     // covers no mask position
  float centroid_u, centroid_v;  // of the clipped triangle: pixels from the upper left corner
  float centroid_z;              // depth there; 0 where nobody asks: neither clipped_depth nor tiny
  float alpha;                   // area of the clipped triangle, 0..1
  WideMask mask;
  DepthPlane<float> plane;
  float z_min, z_max;
  glm::vec3 color;  // times alpha; 0 until shaded
};

// The triangle's depth over a pixel, frame coordinates.
inline DepthPlane<float> pixel_plane(const SetupTriangle& triangle, std::int32_t x, std::int32_t y) {
  return {static_cast<float>(triangle.depth.at(x + 0.5, y + 0.5)), static_cast<float>(triangle.depth.dzdx),
          static_cast<float>(triangle.depth.dzdy)};
}

// The 64 x 64 table (the paper), edge tests at any positions, the same at the positions of a grid, or no masks at all.
enum class MaskSource { table, exact, grid, none };

struct BeamFragmentOptions {
  MaskSource mask = MaskSource::table;
  std::vector<SamplePattern> positions;  // of the mask, 32 to a pattern: one for `table`, any for `exact`
  const MaskTable* table = nullptr;      // for MaskSource::table
  const PositionGrid* grid = nullptr;    // for MaskSource::grid
  std::uint32_t fragment_bytes = 0;      // of a fragment as it is passed on
  // What a tiny fragment is given: as many positions as its area fills, the nearest to its centroid, but no more than
  // this. The paper (section 2.2.1) gives it one, the slides (8) "up to 3".
  int tiny_positions = 0;
  // The depth range of the clipped triangle (the paper); else that of the pair, which contains it.
  bool clipped_depth = true;
};

// For masks on a grid, without the clipped triangle's depth range. `grid` must outlive it.
inline BeamFragmentOptions grid_options(const PositionGrid& grid, std::uint32_t fragment_bytes) {
  BeamFragmentOptions options;
  options.mask = MaskSource::grid;
  options.grid = &grid;
  options.fragment_bytes = fragment_bytes;
  options.clipped_depth = false;
  return options;
}

// What a (pixel, triangle) takes while beam_fragment works on it, with itself and its fragment: those two twice, as
// vectors that grow move from one place to the next.
inline constexpr std::size_t kPairBytes =
    2 * (sizeof(PixelTriangle) + sizeof(Fragment)) + sizeof(TriangleInPixel) + sizeof(Coverage<float>) +
    sizeof(DepthRangeInput<float>) + sizeof(DepthRange<float>) + std::max(sizeof(TableTriangle), sizeof(CellEdges)) +
    sizeof(WideMask) + sizeof(std::uint32_t);

// Areas up to this are what rounding leaves of an area of 0, in pixels.
inline constexpr float kZeroArea = 5e-7f;

// Appends to `out` in the order of `in`; pixels whose coverage turns out 0 are dropped (items_in - items_out counts
// them).
void beam_fragment(const SetupTriangles& triangles, const std::vector<PixelTriangle>& in, const Tile& tile,
                   const BeamFragmentOptions& options, StageCounters& counters, std::vector<Fragment>& out);

}  // namespace beampipe
