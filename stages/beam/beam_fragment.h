// beam_fragment: pairs -> fragments. Computes all that is known about a triangle's visibility in one pixel: the area of
// the clipped triangle and its centroid, the mask, the depth plane and the depth range.
#pragma once

#include <cstdint>
#include <vector>

#include "simd/mask_table.h"
#include "simd/position_mask.h"
#include "simd/sample_pattern.h"
#include "stages/cost/counters.h"
#include "stages/data/alpha_places.h"
#include "stages/data/fragment.h"
#include "stages/data/pair.h"
#include "stages/data/setup_triangle.h"
#include "stages/data/tile.h"

namespace beampipe {

// Where masks come from: the table of the published rules, edge tests at arbitrary positions, edge tests at the
// positions of a grid; or there are no masks.
enum class MaskSource { table, exact, grid, none };

struct BeamFragmentOptions {
  MaskSource mask = MaskSource::table;
  std::vector<SamplePattern> positions = {};  // 32 mask positions per pattern: one pattern for `table`, any for `exact`
  const MaskTable* table = nullptr;           // for MaskSource::table
  const PositionGrid* grid = nullptr;         // for MaskSource::grid
  std::uint32_t fragment_bytes = 0;           // size of a fragment that is passed on, in the modelled machine
  std::uint32_t whole_fragment_bytes = 0;     // the same of one that covers its pixel; 0: the same size
  // A speck gets as many positions as its area fills, the nearest to its centroid, but at most this many. The paper
  // (section 2.2.1) gives it one, the slides (slide 8) "up to 3".
  int tiny_positions = 0;
  // Use the depth range of the clipped triangle, as the published rules do. If not, use the wider depth bounds of the
  // pair.
  bool clipped_depth = true;
  AlphaPlaces alpha = AlphaPlaces::sixteenths;  // for the stage that takes alpha away
};

// Options for masks on a grid, without the depth range of the clipped triangle. `grid` must outlive the result.
inline BeamFragmentOptions grid_options(const PositionGrid& grid, std::uint32_t fragment_bytes,
                                        std::uint32_t whole_fragment_bytes = 0) {
  BeamFragmentOptions options;
  options.mask = MaskSource::grid;
  options.grid = &grid;
  options.fragment_bytes = fragment_bytes;
  options.whole_fragment_bytes = whole_fragment_bytes;
  options.clipped_depth = false;
  return options;
}

// Working memory per pair, with its fragment. Both count twice, because a growing vector copies its contents from one
// place to another.
inline constexpr std::size_t kPairWorkingBytes = 2 * (sizeof(Pair) + sizeof(Fragment));

// An area up to this, in pixels, is a rounding error of an area of 0.
inline constexpr float kZeroArea = 5e-7f;

// Appends to `out` in the order of `in`. Pairs whose area is 0 are dropped; items_in - items_out counts them.
void beam_fragment(const SetupTriangles& triangles, const std::vector<Pair>& in, const Tile& tile,
                   const BeamFragmentOptions& options, StageCounters& counters, std::vector<Fragment>& out);

}  // namespace beampipe
