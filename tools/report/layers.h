// The pictures of the page: those of the techniques, and a map of each per-pixel counter.
#pragma once

#include <vector>

#include "tools/report/report_file.h"
#include "traces/files/json.h"

namespace beampipe {

// The most pixels that the pictures of one page have together: six frames of 320 x 180 with six pictures each. Every
// counter of a frame has a map of the same size, so a page of so many pixels has about 25 MB.
inline constexpr std::uint64_t kMostPagePixels = 2'100'000;

// The positions in the report of the frames whose pictures are on the page: all, or, if they are more than the pixels
// allow, evenly spaced ones with the first and the last. The frame at `shown` is always one of them.
std::vector<std::size_t> frames_of_page(std::size_t frames, std::uint64_t pixels_of_a_frame, std::size_t shown);

// The layers of one frame, which is at `position` in the report:
//   {"frame": 0, "width": 320, "height": 180,
//    "techniques": [{"technique": "beam", "picture": {"low", "high", "png"}, "maps": [MAP, ...]}, ...],
//    "kinds": [{"name": "fragments", "unit": "...", "definition": "..."}, ...]}
// Each "png" is a data: URL. That of a picture is twice as high as the picture: its upper half has the high and its
// lower half the low bytes of q, 0..65535, in red, green and blue; q stands for the linear value
// low + (high - low) * (q / 65535)^2. A MAP {"name", "low", "step", "high", "png"} encodes one value per pixel: its red
// and green bytes form q = 256 red + green, which stands for the value low + q * step. For whole numbers that span at
// most 65535, step is 1 and the values are exact. low is 0 unless some values are negative. Values that are not finite
// become 0. Throws ReportError, ImageError, TraceError and JsonError.
Json report_layers(const ReportFile& report, std::size_t position);

// The layers of all frames of the page, in their order.
Json page_layers(const ReportFile& report, std::size_t shown);

}  // namespace beampipe
