// The histories of pixels that `compare` has recorded, for the page.
#pragma once

#include "tools/report/report_file.h"
#include "traces/files/json.h"

namespace beampipe {

// A list of {"technique", "frame", "x", "y", "error", "causes", "svg", "text"}, as in the files that the report names.
// Throws TraceError and JsonError, and ReportError if a file is not in the report's folder.
Json report_inspections(const ReportFile& report);

}  // namespace beampipe
