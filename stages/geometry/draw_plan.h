// Fixed-function state (traces/draw_state.h) -> where each draw of a frame goes, and what is left out.
//
// In the API's order, viewports, scissors, depth ranges and biases act here, and all else where fragments meet
// (stages/rop/rop_rules.h). Nothing is left out.
//
// By depth, techniques know one depth test, `less` against a depth that everything opaque writes, and one blend
// function. So state is expressed by where triangles lie: viewports move them, viewports and scissors clip them, and
// the order of painting becomes an order of depths (stages/geometry/depth_order.h). What cannot be expressed so is left
// out, or drawn in the nearest way, and noted.
//
// Left out: stencil tests other than `always`; blending that is neither alpha blending nor replacing; draws that write
// no colour. What shaders say of depth and coverage is noted, too. Of draws without colour, those are not noted that
// change nothing: a depth pre-pass whose triangles a later draw with depth function less_equal, equal or greater_equal
// draws again.
#pragma once

#include <vector>

#include "stages/data/draw_placement.h"
#include "stages/geometry/draw_notes.h"
#include "traces/trace.h"

namespace beampipe {

struct DrawPlan {
  std::vector<DrawPlacement> placements;  // one per draw; empty: no draw of the frame has state or a program
  std::vector<DrawNote> notes;
};

DrawPlan plan_draws(const Trace& trace, const Frame& frame, DrawOrder order = DrawOrder::by_depth);

// Do the frame's draws ask for what depths cannot express? That is so if something is noted above, or if a draw is
// blended by its state, because blending depends on the order, or if clears of the depth buffer leave parts of the frame
// fewer depths. False only if what is drawn by depth is what the API draws. Frames without state and programs have no
// order: what lies on the far plane is drawn as well.
bool needs_api_order(const Trace& trace, const Frame& frame);

}  // namespace beampipe
