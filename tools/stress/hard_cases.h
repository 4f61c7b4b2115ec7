// Traces that are hard on arithmetic, with what is known exactly about their pictures.
#pragma once

#include <functional>
#include <glm/glm.hpp>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "traces/trace.h"

namespace beampipe {

// The largest error that a technique may have in a case, and the known reason for it.
struct StatedLimit {
  double error;
  std::string reason;
};

// Every pixel's RGBA is finite and between these.
struct PictureBounds {
  glm::dvec4 low, high;
};

struct HardCase {
  std::string name;
  std::string what;  // what makes the case hard: a short phrase
  Trace trace;       // one frame
  // The RGBA of every pixel, if it follows from how the trace was made. Otherwise tools/stress/exact.h computes it.
  std::optional<glm::dvec4> everywhere;
  // By spec, or by the start of specs up to a ":" or ","; the longest one that fits counts. All other techniques must
  // be correct to the last bit of their formats.
  std::map<std::string, StatedLimit> limits;
  // Of surfaces that vary, for which there is no exact picture: either what it may hold, or a trace whose picture must
  // be the same to the last bit.
  std::optional<PictureBounds> between = {};
  std::optional<Trace> equals = {};
};

// An upper bound of the part of a pixel, 0..1, that a straight edge can cut off without touching any of so many mask
// positions (cell_patterns in simd/sample_pattern.h).
double largest_cut(int positions);

// All cases in a fixed order; `with_heavy` adds those that take gigabytes and minutes.
std::vector<HardCase> hard_cases(bool with_heavy);

}  // namespace beampipe
