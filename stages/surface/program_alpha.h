// Where the surfaces of draws with a program are.
#pragma once

#include "traces/trace.h"

namespace beampipe {

// Of a draw with a program. blend: its blend function, if it does not replace what is stored, uses the shader's alpha.
// mask: the shader may discard, so that a surface is there where it does not.
AlphaMode program_alpha_mode(const Trace& trace, const Draw& draw);

}  // namespace beampipe
