// vertex_setup: draws -> setup triangles.
//
// Transform to clip space (double precision), cull, clip to the near and far planes and, where the triangle reaches
// beyond it, to the guard band; project, snap to 1/256 px, depth plane. Triangles outside the view volume, of zero area
// after snapping, or with a vertex that is not finite are dropped.
// Double precision knows a vertex that is 10^14 px away to 1/64 px: from 10^15 px on, edges lie beside their place, and
// from 10^17 px on, parts of what is clipped are missing.
#pragma once

#include "stages/cost/counters.h"
#include "stages/data/setup_triangle.h"
#include "traces/trace.h"

namespace beampipe {

// Pixels beyond the viewport's origin, on every side, that a snapped vertex may lie at: 2^23 in 1/256 px.
inline constexpr double kGuardBand = 32768.0;

// Runs on the threads that oneTBB has where it is called; the result does not depend on them.
SetupTriangles vertex_setup(const Trace& trace, const Frame& frame, StageCounters& counters);

}  // namespace beampipe
