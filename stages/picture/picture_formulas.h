// The formulas of resolving, for numbers and for numbers that count (stages/cost/counting.h).
#pragma once

#include "simd/scalar.h"

namespace beampipe {

// Blends an aggregate over the background, which shows as far as the aggregate leaves it. `color`: stored as fp16.
template <class Real>
void over_background(const Real color[3], Real alpha, const Real background[3], Real pixel[3]) {
  const Real rest = Real(1.0f) - alpha;
  for (int c = 0; c < 3; ++c) pixel[c] = converted(color[c]) + background[c] * rest;
}

}  // namespace beampipe
