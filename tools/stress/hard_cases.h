// Traces that are hard on arithmetic, with what is known exactly about their pictures.
#pragma once

#include <functional>
#include <glm/glm.hpp>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/technique.h"
#include "tools/stress/exact.h"
#include "traces/trace.h"

namespace beampipe {

// The largest error that a technique may have in a case, and the known reason for it.
struct StatedLimit {
  std::function<double(int places)> error;  // places: sample positions of the technique in a pixel, or mask positions
  std::string reason;

  StatedLimit() = default;
  StatedLimit(double of_any, std::string why) : error([of_any](int) { return of_any; }), reason(std::move(why)) {}
  StatedLimit(std::function<double(int places)> by_places, std::string why)
      : error(std::move(by_places)), reason(std::move(why)) {}
};
using StatedLimits = std::map<ErrorSource, StatedLimit>;

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
  // The largest of those that a technique errs by counts. Where there is none, it must be correct to the last bit of
  // its formats.
  StatedLimits limits;
  // Of surfaces that vary, for which there is no exact picture: either which colours it may hold where exact arithmetic
  // says that triangles cover a pixel, or a trace whose picture must be the same to the last bit.
  std::optional<ColorBounds> between = {};
  std::optional<Trace> equals = {};
};

// An upper bound of the part of a pixel, 0..1, that a straight edge can cut off without touching any of so many mask
// positions (cell_patterns in simd/sample_pattern.h).
double largest_cut(int positions);

// All cases in a fixed order.
std::vector<HardCase> hard_cases();

}  // namespace beampipe
