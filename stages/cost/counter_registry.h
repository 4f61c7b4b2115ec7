// Every counter and every stage by name: report.json is written, and docs/counters.md is generated, from this list.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "stages/cost/counters.h"

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

// A stage, and the tests that check its counters: names of ctest, without the scene that a test is run on;
// several have ", " between them.
struct StageInfo {
  const char* name;
  const char* items_in;   // what they are
  const char* items_out;  // likewise
  const char* lanes;      // what is used out of what is issued; "": nothing, as lanes are not counted
  const char* silent;     // counters that stay 0 there on every scene, beside lanes: " ops.fetch ops.special "
  const char* items_test;
  const char* ops_test;      // that holds them to the scalar twin
  const char* logical_test;  // bytes_read, bytes_written, logical_bytes
  const char* memory_test;   // sector_bytes, dram_bytes
  const char* lanes_test;
};

const std::vector<StageInfo>& stage_list();

// Does the counter count anything in that stage?
bool has_counter(const StageInfo& stage, const CounterInfo& counter);

// The test that checks it there.
const char* test_of(const StageInfo& stage, const CounterInfo& counter);

// Of a pixel: channels of frame_NNNN_counters.exr.
struct PixelCounterInfo {
  const char* name;
  const char* unit;
  const char* meaning;
  const char* techniques;
  const char* test;
};

const std::vector<PixelCounterInfo>& pixel_counters();

// What comparisons with the reference add to them.
const std::vector<PixelCounterInfo>& error_counters();

// Of a frame: keys of report.json.
struct FrameCounterInfo {
  const char* name;
  const char* unit;
  const char* meaning;
  const char* test;
};

const std::vector<FrameCounterInfo>& frame_counters();

// docs/counters.md.
std::string counters_page();

}  // namespace beampipe
