// Writes report.json. Its keys are a contract: new ones may be added, but none may be renamed or removed.
#pragma once

#include "tools/evaluate/results.h"
#include "traces/json.h"

namespace beampipe {

Json to_json(const Report& report);

}  // namespace beampipe
