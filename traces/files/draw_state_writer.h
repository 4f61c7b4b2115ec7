// Writing the fixed-function state of a draw.
#pragma once

#include "traces/draw_state.h"
#include "traces/files/trace_text.h"

namespace beampipe {

// Adds "state", with what differs from the defaults, to the object that is open. Throws std::runtime_error.
void write_draw_state(TraceText& text, const DrawState& state);

}  // namespace beampipe
