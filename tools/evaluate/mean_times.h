// Modelled times of a run's frames, as one number.
#pragma once

#include <cstddef>

#include "tools/evaluate/results.h"

namespace beampipe {

// Milliseconds, the means over the frames: one stage after the other, and all at once.
struct MeanTimes {
  double in_turn_ms = 0, at_once_ms = 0;
};

// `implementation`: its number in the hardware. The result has a frame.
MeanTimes mean_times(const Hardware& hardware, std::size_t implementation, const TechniqueReport& result);

}  // namespace beampipe
