// sample_raster: setup triangles -> sample fragments: the samples of each cell that a triangle covers.
//
// Coverage is exact and follows the top-left rule: a sample on an edge that two triangles share belongs to exactly one
// of them.
#pragma once

#include <vector>

#include "stages/cost/counters.h"
#include "stages/data/closed_depth.h"
#include "stages/data/sample_fragment.h"
#include "stages/data/setup_triangle.h"
#include "stages/data/tile.h"

namespace beampipe {

// Appends to `out`, triangle by triangle in the order of the list. With `closed`, which belongs to cells_of(in.tile), a
// triangle is left out of cells that another one covers completely and in front of all its vertices, in this list or in
// earlier calls: none of its samples would pass the depth test there.
void sample_raster(const SampledTriangles& in, const TriangleList& list, StageCounters& counters,
                   std::vector<SampleFragment>& out, ClosedDepth* closed = nullptr);

}  // namespace beampipe
