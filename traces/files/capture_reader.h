// The parts of a trace that say where it was captured and what the program itself drew.
#pragma once

#include "traces/capture_record.h"
#include "traces/files/array_reader.h"
#include "traces/files/json_cursor.h"
#include "traces/files/surface_reader.h"
#include "traces/trace.h"

namespace beampipe {

// Throw TraceError.
Source read_source(const JsonCursor& at);

// Of the members "passes", "left_out" and "captured" of a frame, which has its size already.
CaptureRecord read_capture_record(const JsonCursor& at, const Frame& frame, const std::vector<TextureImage>& images,
                                  const NameIndex& image_names, const ArrayReader& arrays);

}  // namespace beampipe
