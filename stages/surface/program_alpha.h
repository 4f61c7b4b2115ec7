// Where the surfaces of draws are, as far as it depends on a program or on the API's order.
#pragma once

#include <string>
#include <vector>

#include "stages/data/draw_placement.h"
#include "traces/trace.h"

namespace beampipe {

// Of a draw with a program. mask: the shader may discard, so that a surface is there where it does not. blend, where
// the order is by depth: its blend function, if it does not replace what is stored, uses the shader's alpha. In the
// API's order, blending is no property of the surface; and draws have a mask whose shader says more of their fragments
// (stages/surface/fragment_verdict.h).
AlphaMode program_alpha_mode(const Trace& trace, const Draw& draw, DrawOrder order);

// What a draw asks of its fragments that only the API's order does, each in words for a note. Empty: nothing.
std::vector<std::string> fragment_requests(const Trace& trace, const Draw& draw);

}  // namespace beampipe
