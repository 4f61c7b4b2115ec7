// report.json, as it is written. Its keys are a contract: add, never rename.
#pragma once

#include <string>

#include "tools/evaluate/results.h"
#include "traces/json.h"

namespace beampipe {

Json to_json(const ErrorStats& stats);
Json to_json(const Report& report);

// A frame of report.json. `technique` tells the framebuffer, and `hardware` how to model times; both may be empty.
Json to_json(const FrameReport& frame, const TechniqueReport& technique, const Hardware& hardware);

// The frame that to_json wrote, with an empty framebuffer; `pixels` is not in it. Throws JsonError when it is another
// JSON.
FrameReport frame_of(const Json& json);

// The text of a JSON file; bytes that are not UTF-8 are replaced.
std::string json_text(const Json& json);

}  // namespace beampipe
