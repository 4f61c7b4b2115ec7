// conservative_raster: setup triangles -> pairs: every pixel whose closed square the closed triangle touches.
#pragma once

#include <vector>

#include "stages/cost/counters.h"
#include "stages/data/closed_depth.h"
#include "stages/data/pair.h"
#include "stages/data/setup_triangle.h"
#include "stages/data/tile.h"

namespace beampipe {

// Do pairs get their depth bounds? If not, nearest and farthest are 0.
enum class PairDepths { bounds, none };

// Who closes pixels: the raster, where a triangle covers them completely, or a later stage alone.
enum class Closing { by_raster, by_later_stage };

struct ConservativeOptions {
  ClosedDepth* closed = nullptr;
  PairDepths depths = PairDepths::bounds;
  Closing closing = Closing::by_raster;
};

// Appends to `out`, triangle by triangle in the order of the list. With `closed`, leaves out what is hidden behind
// triangles that cover whole pixels, in this list or in earlier calls. Returns the largest size of `out`, which may be
// more than its size at the end: pairs that turned out to be hidden behind a later triangle are removed.
std::size_t conservative_raster(const SetupTriangles& triangles, const TriangleList& list, const Tile& tile,
                                StageCounters& counters, std::vector<Pair>& out,
                                const ConservativeOptions& options = {});

}  // namespace beampipe
