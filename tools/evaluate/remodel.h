// The counts of finished runs, to model their times on other hardware without rendering again.
#pragma once

#include <vector>

#include "tools/evaluate/results.h"
#include "traces/files/json.h"

namespace beampipe {

// Of report.json: trace, what made it, whether memory was modelled, and the stages and buffers of every technique's
// frames. `all`: at least one. Throws JsonError if it is something else.
Report remodelled(const Json& report, const std::vector<Hardware>& all);

}  // namespace beampipe
