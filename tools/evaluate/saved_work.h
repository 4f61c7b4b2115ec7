// Work that a technique avoided. The amounts follow from the stages' counters; nothing else is counted for them.
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

// Of one frame. Empty if the technique takes no shortcuts.
std::vector<SavedWork> saved_work(const std::vector<StageCounters>& stages);

}  // namespace beampipe
