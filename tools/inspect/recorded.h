// Inspections that `compare` leaves beside its pictures, for the report page.
#pragma once

#include <string>
#include <vector>

#include "tools/inspect/inspection.h"
#include "traces/files/json.h"

namespace beampipe {

// The file in a technique's folder.
inline constexpr const char* kInspectionsFile = "inspections.json";

// What the file holds: for each inspection its JSON, and "svg" and "text", its picture and text. `trace`: its name.
Json recorded_inspections(const std::vector<PixelInspection>& inspections, const std::string& trace);

}  // namespace beampipe
