// The JSON of one frame's results, as report.json and the records of unfinished runs contain it.
#pragma once

#include <string_view>
#include <vector>

#include "tools/evaluate/hardware.h"
#include "tools/evaluate/metrics.h"
#include "tools/evaluate/results.h"
#include "traces/files/json_form.h"

namespace beampipe {

inline constexpr const char* kABuffer = "a_buffer";  // its name among the buffers of a frame

// {"rmse": ..., "bias": ...}: measures() that have a value; and back. error_of() throws JsonError if a number is
// missing.
Form<ErrorStats> error_form();
ErrorStats error_of(const Json& json);

// {"rmse": ...}
Form<double> rmse_form();

// The JSON Schema of a frame in report.json.
Json frame_schema();

// A frame, as in report.json. The framebuffer of `technique` and times and energy modelled for `hardware` are
// included; both may be empty.
Json to_json(const FrameReport& frame, const TechniqueReport& technique, const Hardware& hardware);

// The one of "stages" that is called so; null if there is none.
Json* find_stage(std::vector<Json>& stages, std::string_view name);

// Reads back a frame that was written with an empty framebuffer, except for `pixels`, which is not in the JSON. Throws
// JsonError if a key is missing or a value has the wrong type.
FrameReport frame_of(const Json& json);

// All of a frame, to be read back.
Json stored_json(const FrameReport& frame);
FrameReport stored_frame(const Json& json);  // throws as above

}  // namespace beampipe
