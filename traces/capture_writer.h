// Writing where a trace was captured and what the program itself drew.
#pragma once

#include "traces/trace.h"
#include "traces/trace_text.h"

namespace beampipe {

// Add members to the object that is open. Throw std::runtime_error.
void write_source(TraceText& text, const Source& source);
void write_capture_record(TraceText& text, const CaptureRecord& record, const Trace& trace);

}  // namespace beampipe
