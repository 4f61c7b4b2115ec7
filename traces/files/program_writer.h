// Writing what programs brought: their fragment shaders, images and samplers, and what draws bind.
#pragma once

#include "traces/files/trace_text.h"
#include "traces/trace.h"

namespace beampipe {

// Add members to the object that is open. All throw std::runtime_error if a reader would refuse them.
void write_programs(TraceText& text, const Trace& trace);
void write_program_use(TraceText& text, const ProgramUse& use, const Trace& trace);

}  // namespace beampipe
