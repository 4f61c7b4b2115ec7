// What resolve is charged.
#pragma once

#include <vector>

#include "stages/cost/counting.h"
#include "stages/data/pixel_formats.h"
#include "stages/picture/picture_formulas.h"

namespace beampipe {

inline OperationCounts over_background_cost() {
  return count_operations([](OperationCounts& counts) {
    const Counted<float> one(1.0f, counts), color[3] = {one, one, one};
    Counted<float> pixel[3];
    over_background(color, one, color, pixel);
  });
}

// The mean of one channel over a pixel's samples, which are stored as fp16. resolve() computes the same sum from runs
// of equal samples.
template <class Real>
Real box_filter(const std::vector<Real>& samples) {
  Real sum(0.0f);
  for (const Real& sample : samples) sum = sum + converted(sample);
  return sum * Real(1.0f / static_cast<float>(samples.size()));
}

inline OperationCounts box_filter_cost(std::size_t samples) {
  return count_operations([&](OperationCounts& counts) {
    for (int c = 0; c < 3; ++c) box_filter(std::vector<Counted<float>>(samples, Counted<float>(1.0f, counts)));
  });
}

// A pixel's samples are compressed, and their mean is expanded.
inline OperationCounts reinhard_cost(std::size_t samples) {
  return count_operations([&](OperationCounts& counts) {
    const Counted<float> one(1.0f, counts);
    Counted<float> color[3] = {one, one, one};
    for (std::size_t s = 0; s < samples; ++s) compress(color);
    expand(color);
  });
}

}  // namespace beampipe
