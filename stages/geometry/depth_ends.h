// Where depths reach the ends of what a depth buffer stores.
#pragma once

#include "traces/trace.h"

namespace beampipe {

// May fragments of the draw have a window depth of 0 or 1, other than along lines? So it is where a whole triangle lies
// on the near or far plane, or beyond if nothing is clipped there, and where a bias takes what it draws to an end: that
// of the draw's own range, if nothing is clipped. Errs towards yes. Time: linear in the draw's triangles.
bool reaches_ends(const Trace& trace, const Frame& frame, const Draw& draw);

}  // namespace beampipe
