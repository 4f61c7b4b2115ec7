// Traces that are hard on arithmetic, each with what is exactly true of it.
#pragma once

#include <functional>
#include <glm/glm.hpp>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "traces/trace.h"

namespace beampipe {

// How far a technique may be from the truth in one case, and why: what it is known not to do.
struct StatedLimit {
  double error;
  std::string reason;
};

struct HardCase {
  std::string name;
  std::string what;  // is hard about it
  Trace trace;       // one frame
  // What every pixel is, where it follows from how the trace was made; else tools/stress/exact.h works the picture out.
  std::optional<glm::dvec4> everywhere;
  // By a spec, or what it starts with up to a ":" or ",": the longest counts. Others must be right to the last bit of
  // their formats.
  std::map<std::string, StatedLimit> limits;
};

// An upper bound of the part of a pixel, 0..1, that a straight edge can cut off without one of so many mask positions
// (simd/sample_pattern.h: cell_patterns).
double largest_cut(int positions);

// In a fixed order. Heavy: also those that take gigabytes and minutes.
std::vector<HardCase> hard_cases(bool with_heavy);

}  // namespace beampipe
