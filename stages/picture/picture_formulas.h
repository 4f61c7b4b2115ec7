// The formulas of shading and resolving, for numbers and for numbers that count (stages/cost/counting.h).
#pragma once

#include "simd/scalar.h"

namespace beampipe {

// Lambert's law: kd times max(0, -normal . light).
template <class Real>
void lambert(const Real kd[3], const Real normal[3], const Real light[3], Real color[3]) {
  const Real zero(0.0f);
  const Real cosine = greater(zero - (normal[0] * light[0] + normal[1] * light[1] + normal[2] * light[2]), zero);
  for (int c = 0; c < 3; ++c) color[c] = kd[c] * cosine;
}

// Blends an aggregate over the background, which shows as far as the aggregate leaves it. `color`: stored as fp16.
template <class Real>
void over_background(const Real color[3], Real alpha, const Real background[3], Real pixel[3]) {
  const Real rest = Real(1.0f) - alpha;
  for (int c = 0; c < 3; ++c) pixel[c] = converted(color[c]) + background[c] * rest;
}

}  // namespace beampipe
