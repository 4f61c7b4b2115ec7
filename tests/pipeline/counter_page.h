// docs/counters.md: every counter of the registry, and the tests that check it.
#pragma once

#include <string>
#include <vector>

#include "stages/cost/counter_registry.h"

namespace beampipe {

// Names of tests as ctest has them, without the scene that a test runs on; several have ", " between them.
// They throw std::out_of_range for a stage or a counter whose tests are not listed in counter_page.cpp.
std::string tests_of(const StageInfo& stage, const CounterInfo& counter);
std::string tests_of(const PixelCounterInfo& counter);
std::string tests_of(const FrameCounterInfo& counter);

std::string counters_page();

}  // namespace beampipe
