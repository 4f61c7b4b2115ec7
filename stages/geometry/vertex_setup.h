// vertex_setup: draws -> setup triangles.
//
// Transforms to clip space in double precision, culls, clips to the near and far planes (and to the guard band, if the
// triangle extends beyond it), projects, snaps to 1/256 px and computes the depth plane. Triangles are dropped if they
// lie outside the view volume, if their area is zero after snapping, or if a vertex is not finite.
//
// Draws with fixed-function state go where plan_draws (stages/geometry/draw_plan.h) puts them, by `order`. Where they
// reach beyond their viewport or scissor, they are clipped to it instead of the guard band: the crossing points then
// lie on its sides, so no sample outside is covered.
//
// Double precision resolves a vertex that is 10^14 px away to 1/64 px. From 10^15 px on, edges are displaced, and from
// 10^17 px on, parts of clipped triangles are missing.
#pragma once

#include "stages/cost/counters.h"
#include "stages/data/setup_triangle.h"
#include "traces/trace.h"

namespace beampipe {

// Runs on the threads of the oneTBB arena that it is called in. The result does not depend on their number. Sets the
// counters' stage name. `numbers_triangles`: SetupTriangles::trace_triangles is wanted.
SetupTriangles vertex_setup(const Trace& trace, const Frame& frame, StageCounters& counters,
                            bool numbers_triangles = false, DrawOrder order = DrawOrder::by_depth);

// Does the frame draw a triangle that is not flat? One that is culled or out of view counts too.
bool has_varying_surfaces(const Trace& trace, const Frame& frame);

}  // namespace beampipe
