// Traces that are hard on arithmetic, each with what is exactly true of it.
#pragma once

#include <functional>
#include <glm/glm.hpp>
#include <map>
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
  // The exact picture where it follows from how the trace was made; empty: tools/stress/exact.h works it out.
  std::vector<glm::dvec4> closed_form;
  // By the name of a technique, what stands before ":" or the whole spec. Others must be right to the last bit of their
  // formats.
  std::map<std::string, StatedLimit> limits;
};

// An upper bound of the part of a pixel, 0..1, that a straight edge can cut off without one of so many mask positions
// (simd/sample_pattern.h: cell_patterns).
double largest_cut(int positions);

// In a fixed order. Heavy: also one that takes a gigabyte and a minute.
std::vector<HardCase> hard_cases(bool with_heavy);

}  // namespace beampipe
