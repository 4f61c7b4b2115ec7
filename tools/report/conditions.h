// Under which conditions the numbers of a report were found.
#pragma once

#include <string>

#include "tools/report/report_file.h"
#include "traces/files/json.h"

namespace beampipe {

// [[NAME, TEXT], ...]: the picture, the scene, the command, the hardware, the memory system, the program, and what the
// trace asks for and no technique does. What an older report does not have is left out. Throws JsonError.
Json report_conditions(const ReportFile& report);

}  // namespace beampipe
