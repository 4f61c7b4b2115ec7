// The order of painting as an order of depths.
//
// A depth buffer that is cleared starts a group of draws, and later groups lie in front of earlier ones. Within a group
// there are, from far to near:
//   1. what is drawn before anything writes depth and writes none itself (skies), in the order of painting;
//   2. what tests or writes depth, at its own depths;
//   3. what is drawn after that without a depth test (head-up displays), in the order of painting.
// If nothing in a group writes depth, all of it is painted. Painted triangles are flat: each has one depth, nearer than
// that of the triangle painted before it.
//
// Near is at window depth 1 where depth is cleared to 0.
//
// Depths of the frame. Those of the group that tests most triangles stay in -1..0, with their precision: window depth
// minus 1, or minus the window depth if near is at 1. What lies behind goes to 0..1, what lies in front to -2..-1; each
// part of a group has an equal share there.
//
// At equal depth the earlier triangle wins in every technique. So triangles of draws that win against earlier ones
// (DrawPlacement::last_wins) come first, in reverse order.
#pragma once

#include <cstdint>
#include <vector>

#include "stages/data/draw_placement.h"
#include "stages/geometry/draw_notes.h"
#include "traces/trace.h"

namespace beampipe {

// Sets depths, bias and last_wins of the draws that are drawn. Notes what depths cannot express.
// `geometry`: geometry_numbers of the frame.
void order_depths(const Trace& trace, const Frame& frame, const std::vector<std::uint32_t>& geometry,
                  std::vector<DrawPlacement>& placements, std::vector<DrawNote>& notes);

// Does a triangle of the draw have a material that is blended?
bool is_translucent(const Trace& trace, const Draw& draw);

// May the draw's material or program leave out parts of triangles?
bool may_be_cut_out(const Trace& trace, const Draw& draw);

}  // namespace beampipe
