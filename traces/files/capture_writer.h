// Writing where a trace was captured and what the program itself drew.
#pragma once

#include "traces/files/trace_text.h"
#include "traces/trace.h"

namespace beampipe {

// Add members to the object that is open. Throw std::runtime_error.
void write_source(TraceText& text, const Source& source);
void write_capture_record(TraceText& text, const CaptureRecord& record, const Trace& trace);

}  // namespace beampipe
