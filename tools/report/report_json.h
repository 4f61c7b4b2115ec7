// Writes report.json. Its keys are a contract: new ones may be added, but none may be renamed or removed.
#pragma once

#include <functional>
#include <string_view>

#include "tools/evaluate/results.h"

namespace beampipe {

// Passes the text on, frame after frame: a report of many frames is too large for memory.
using WriteText = std::function<void(std::string_view)>;
void write_json(const Report& report, const WriteText& write);

// The JSON Schema of report.json.
Json report_schema();

}  // namespace beampipe
