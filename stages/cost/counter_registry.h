// The counters of a pixel and of a frame, by name and meaning. The report takes its columns and definitions from them,
// and `beampipe counters` prints them. Those of a stage are in stages/cost/counters.h.
#pragma once

#include <vector>

namespace beampipe {

// A counter of a pixel: a channel of frame_NNNN_counters.exr. Techniques say themselves which ones they have
// (TechniqueKind::counters).
struct PixelCounterInfo {
  const char* name;
  const char* unit;
  const char* meaning;
  const char* where = "";  // what else it takes: options of a technique, or of a command
};

const std::vector<PixelCounterInfo>& pixel_counters();

// The channels that a comparison with the reference adds.
const std::vector<PixelCounterInfo>& error_counters();

// A counter of a frame: a key of report.json, or several with ", " between them.
struct FrameCounterInfo {
  const char* name;
  const char* unit;
  const char* meaning;
};

const std::vector<FrameCounterInfo>& frame_counters();

}  // namespace beampipe
