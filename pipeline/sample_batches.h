// What the techniques that test samples share: the raster stage in batches.
#pragma once

#include <vector>

#include "pipeline/batches.h"
#include "pipeline/tiles.h"
#include "pipeline/timeline.h"
#include "stages/data/tile.h"
#include "stages/raster/sample_raster.h"

namespace beampipe {

// One pass of sample_raster over the list's triangles in order, with nothing behind the cells that it has closed so
// far, as a hierarchical depth buffer does it; calls body(fragments) for each batch, which `held` is told of.
template <class Body>
void raster_in_batches(const SetupTriangles& triangles, const TriangleList& list, const Tile& tile,
                       const Sampling& sampling, const StageTimer& timed, StageCounters& raster, BinBuffers& held,
                       Body&& body) {
  std::vector<SampleFragment> fragments;
  ClosedDepth closed(cells_of(tile, sampling.grid));
  held.holds("closed_depth", closed.bytes());
  for_each_batch(list, [&](const TriangleList& batch) {
    fragments.clear();
    sample_raster(triangles, batch, tile, sampling, timed(raster), fragments, &closed);
    held.holds("batch_fragments", fragments.size() * kSampleFragmentBytes);
    body(fragments);
  });
}

// Adds one to a pixel's count for each triangle that has a fragment there, in however many cells of it. Fragments of
// one triangle come one after the other.
inline void count_fragments(const std::vector<SampleFragment>& fragments, const Tile& tile, const CellGrid& grid,
                            std::vector<float>& counts) {
  std::vector<std::uint32_t> last(counts.size(), ~0u);  // triangle that was counted last
  for (const SampleFragment& fragment : fragments) {
    const std::int32_t x = grid.pixel_x(fragment.x) - tile.x0, y = grid.pixel_y(fragment.y) - tile.y0;
    const auto pixel = static_cast<std::size_t>(y * tile.width() + x);
    counts[pixel] += last[pixel] != fragment.triangle;
    last[pixel] = fragment.triangle;
  }
}

}  // namespace beampipe
