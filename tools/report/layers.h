// What the page shows per pixel: each technique's picture and, per counter, a map of its values.
#pragma once

#include "tools/report/report_file.h"
#include "traces/json.h"

namespace beampipe {

// Of one frame, the `position`-th of the report:
//   {"frame": 0,
//    "techniques": [{"technique": "beam", "picture": PNG, "maps": [MAP, ...]}, ...],
//    "kinds": [{"name": "fragments", "unit": "...", "definition": "..."}, ...]}
// PNG is a data: URL. A MAP {"name", "low", "step", "high", "png"} is a picture whose red and green bytes make the
// 16-bit number q = 256 red + green of each pixel, which stands for the value low + q * step; for counts up to 65535
// step is 1 and they are exact. low is 0 unless there are negative values. What is not finite counts as 0. Throws
// ReportError and ImageError.
Json report_layers(const ReportFile& report, std::size_t position);

}  // namespace beampipe
