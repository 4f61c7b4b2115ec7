// Inspections as JSON: `beampipe inspect --json` and the report page.
#pragma once

#include "tools/inspect/inspection.h"
#include "traces/files/json_form.h"

namespace beampipe {

// Indices of fragments are those of its list "fragments"; null stands for the background or an empty position.
Json to_json(const PixelInspection& inspection);

// The JSON Schema of what `inspect` prints and of the files inspections.json.
Json inspections_schema();

}  // namespace beampipe
