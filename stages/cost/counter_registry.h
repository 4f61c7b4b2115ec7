// The counters by name and meaning: of a stage, of a pixel and of a frame. docs/counters.md is generated from these
// lists, and the report takes its columns and definitions from them.
#pragma once

#include <string_view>
#include <vector>

#include "stages/cost/counters.h"

namespace beampipe {

// A stage, and what its items and lanes are. The counters themselves are stage_counters() (stages/cost/counters.h).
struct StageInfo {
  const char* name;
  const char* items_in;
  const char* items_out;
  const char* lanes_used;    // "" if the stage counts no lanes
  const char* lanes_issued;  // likewise
  // Counters, besides lanes, that stay 0 in this stage for every scene. There are blanks around each name.
  const char* silent;
};

const std::vector<StageInfo>& stage_list();

// The stages of a depth pre-pass are counted apart, under their names with this before it. stage_list() does not list
// them again.
inline constexpr std::string_view kPrepass = "prepass_";

// "depth_test" for "depth_test" and for "prepass_depth_test".
constexpr std::string_view without_pass(std::string_view stage) {
  return stage.starts_with(kPrepass) ? stage.substr(kPrepass.size()) : stage;
}

// Does the counter count anything in this stage?
bool has_counter(const StageInfo& stage, const CounterInfo& counter);

// A counter of a pixel: a channel of frame_NNNN_counters.exr.
struct PixelCounterInfo {
  const char* name;
  const char* unit;
  const char* meaning;
  const char* techniques;
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
