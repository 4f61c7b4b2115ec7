// The fixed-function state of a draw, as traces write it.
#pragma once

#include "traces/draw_state.h"
#include "traces/files/json_cursor.h"

namespace beampipe {

// Throws TraceError.
DrawState read_draw_state(const JsonCursor& at);

}  // namespace beampipe
