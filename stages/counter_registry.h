// Every counter and every stage by name: report.json is written, and docs/counters.md is generated, from this list.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "stages/counters.h"

namespace beampipe {

struct CounterInfo {
  const char* name;   // as in report.json; "ops.add" is `add` of `ops`
  const char* title;  // of a table's column
  const char* unit;
  const char* meaning;
  Count (*value)(const StageCounters&);
};

// Of a stage, in the order in which report.json has them.
const std::vector<CounterInfo>& stage_counters();

struct StageInfo {
  const char* name;
  const char* items_in;   // what they are
  const char* items_out;  // likewise
  const char* lanes;      // what is used out of what is issued
  const char* test;       // that checks its counters
};

const std::vector<StageInfo>& stage_list();

// Of a pixel: channels of frame_NNNN_counters.exr.
struct PixelCounterInfo {
  const char* name;
  const char* unit;
  const char* meaning;
  const char* techniques;
  const char* test;
};

const std::vector<PixelCounterInfo>& pixel_counters();

// docs/counters.md.
std::string counters_page();

}  // namespace beampipe
