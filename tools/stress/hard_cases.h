// Traces that are hard on arithmetic, with what is known exactly about their pictures.
#pragma once

#include <functional>
#include <glm/glm.hpp>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "tools/stress/exact.h"
#include "traces/trace.h"

namespace beampipe {

// The largest error that a technique may have in a case, and the known reason for it.
struct StatedLimit {
  double error;
  std::string reason;
  int positions = 256;  // that it is for, where a technique counts mask positions; it grows as these become fewer
};

// What surfaces may look like: every colour of theirs is finite and between these. The rest of a pixel shows the
// background.
struct ColorBounds {
  glm::dvec3 low, high;
};

struct HardCase {
  std::string name;
  std::string what;  // what makes the case hard: a short phrase
  Trace trace;       // one frame
  // The exact picture, if it follows from how the trace was made. Otherwise tools/stress/exact.h computes it.
  std::optional<ExactPicture> picture;
  // By spec, or by the start of specs up to a ":" or ","; the longest one that fits counts, or else one that fits
  // Technique::errs_like. All other techniques must be correct to the last bit of their formats.
  std::map<std::string, StatedLimit> limits;
  // Of surfaces that vary, for which there is no exact picture: either which colours it may hold where exact arithmetic
  // says that triangles cover a pixel, or a trace whose picture must be the same to the last bit.
  std::optional<ColorBounds> between = {};
  std::optional<Trace> equals = {};
};

// An upper bound of the part of a pixel, 0..1, that a straight edge can cut off without touching any of so many mask
// positions (cell_patterns in simd/sample_pattern.h).
double largest_cut(int positions);

// All cases in a fixed order; `with_heavy` adds those that take gigabytes and minutes.
std::vector<HardCase> hard_cases(bool with_heavy);

}  // namespace beampipe
