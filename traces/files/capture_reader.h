// The parts of a trace that say where it was captured and what the program itself drew.
#pragma once

#include "traces/capture_record.h"
#include "traces/files/array_reader.h"
#include "traces/files/json_cursor.h"
#include "traces/files/surface_reader.h"
#include "traces/trace.h"

namespace beampipe {

Form<Source> source_form();

// Adds "passes", "left_out" and "captured" to the form of frames, which have their size before. All that a form refers
// to must outlive it.
void add_capture(ObjectForm<Frame>& frame, const std::vector<TextureImage>& images, const NameIndex& names,
                 const ArrayReader& arrays);

}  // namespace beampipe
