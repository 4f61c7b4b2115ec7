// Where the surfaces of draws with a program are.
#pragma once

#include "stages/data/draw_placement.h"
#include "traces/trace.h"

namespace beampipe {

// Of a draw with a program. mask: the shader may discard, so that a surface is there where it does not. blend, where
// the order is by depth: its blend function, if it does not replace what is stored, uses the shader's alpha. In the
// API's order, blending is no property of the surface.
AlphaMode program_alpha_mode(const Trace& trace, const Draw& draw, DrawOrder order);

}  // namespace beampipe
