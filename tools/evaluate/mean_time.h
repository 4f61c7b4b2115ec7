// Modelled times of a run's frames as one, and how far they may be off as far as the ranges of the hardware tell.
#pragma once

#include <cstddef>
#include <vector>

#include "tools/evaluate/results.h"
#include "tools/evaluate/sensitivity.h"

namespace beampipe {

// The means over the frames, of which there is at least one; a stage takes no time in a frame that lacks it. Units are
// those of the first frame that has the stage. `implementation`: its number in the hardware.
ModelledTime mean_time(const Hardware& hardware, std::size_t implementation, const TechniqueReport& result);

// The same, and on each of the hardware's draws (sensitivity.h). Nine in ten of the drawn times and the described one
// lie in the interval; and the same of a quotient.
struct DrawnTime {
  ModelledTime described;
  std::vector<ModelledTime> drawn;

  Interval interval(double ModelledTime::*ms) const;
  Interval interval_over(const DrawnTime& other, double ModelledTime::*ms) const;
};

// What is reached of DRAM's peak depends on a technique's requests too. So it is up to a factor of kRequestSpread apart
// between two techniques, differently in each draw: the most that two simulators found between `beam` and `msaa:8`
// (docs/costs.md). Draws are seeded by the technique's name.
inline constexpr double kRequestSpread = 1.26;
DrawnTime drawn_time(const Hardware& hardware, const std::vector<Hardware>& draws, std::size_t implementation,
                     const TechniqueReport& result);

}  // namespace beampipe
