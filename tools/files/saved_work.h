// Work that a technique did not do, as its stages' counters tell: nothing is counted twice for it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "stages/cost/counters.h"

namespace beampipe {

struct SavedWork {
  const char* name;  // in report.json
  const char* title;
  const char* unit;
  const char* meaning;
  std::uint64_t amount;
};

// Of a frame; empty where the technique has no such shortcut.
std::vector<SavedWork> saved_work(const std::vector<StageCounters>& stages);

}  // namespace beampipe
