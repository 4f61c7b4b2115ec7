// The fixed-function state of a draw, as traces write it.
#pragma once

#include "traces/draw_state.h"
#include "traces/files/json_form.h"

namespace beampipe {

const Form<DrawState>& draw_state_form();

}  // namespace beampipe
