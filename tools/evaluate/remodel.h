// The counts of finished runs, to model their times again without rendering.
#pragma once

#include <stdexcept>
#include <vector>

#include "tools/evaluate/results.h"
#include "traces/files/json.h"

namespace beampipe {

// Bytes were counted with another memory system: one line that names the parameter.
struct OtherMemory : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// The memory system of report.json. `file`: its name for errors. Throws JsonError or TraceError if `report` is something
// else.
MemoryParameters memory_of(const Json& report, const std::string& file);

// Of report.json: trace, what made it, memory system, hardware, and the stages, buffers and bins of every technique's
// frames. The hardware is `other`, or, if that is null, the report's own. Options of the run that changed the memory
// system hold for `other` too. Throws OtherMemory if the rest of its memory system is another one, and JsonError or
// TraceError if `report` is something else.
Report remodelled(const Json& report, const Hardware* other = nullptr);

}  // namespace beampipe
