// The pictures of the page: those of the techniques, and a map of each per-pixel counter.
#pragma once

#include "tools/report/report_file.h"
#include "traces/json.h"

namespace beampipe {

// The layers of one frame, which is at `position` in the report:
//   {"frame": 0,
//    "techniques": [{"technique": "beam", "picture": PNG, "maps": [MAP, ...]}, ...],
//    "kinds": [{"name": "fragments", "unit": "...", "definition": "..."}, ...]}
// PNG is a data: URL. A MAP {"name", "low", "step", "high", "png"} is a picture that encodes one value per pixel: its
// red and green bytes form q = 256 red + green, which stands for the value low + q * step. For whole numbers that span
// at most 65535, step is 1 and the values are exact. low is 0 unless some values are negative. Values that are not
// finite become 0. Throws ReportError, ImageError, TraceError and JsonError.
Json report_layers(const ReportFile& report, std::size_t position);

}  // namespace beampipe
