// Writes report.json. Its keys are a contract: new ones may be added, but none may be renamed or removed.
#pragma once

#include <string>

#include "tools/evaluate/results.h"
#include "traces/json.h"

namespace beampipe {

Json to_json(const ErrorStats& stats);
Json to_json(const Report& report);

// A frame, as in report.json. The framebuffer of `technique` and times modelled for `hardware` are included; both may
// be empty.
Json to_json(const FrameReport& frame, const TechniqueReport& technique, const Hardware& hardware);

// Reads back a frame that was written with an empty framebuffer, except for `pixels`, which is not in the JSON. Throws
// JsonError if a key is missing or a value has the wrong type.
FrameReport frame_of(const Json& json);

// The text of a JSON file. Bytes that are not UTF-8 are replaced.
std::string json_text(const Json& json);

}  // namespace beampipe
