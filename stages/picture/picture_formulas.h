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

// Rec. 709.
template <class Real>
Real luminance(const Real color[3]) {
  return color[0] * Real(0.2126f) + color[1] * Real(0.7152f) + color[2] * Real(0.0722f);
}

// Reinhard's operator (Reinhard et al. 2002): a luminance of L becomes L / (1 + L), and the hue stays.
template <class Real>
void compress(Real color[3]) {
  const Real scale = Real(1.0f) / (Real(1.0f) + luminance(color));
  for (int c = 0; c < 3; ++c) color[c] = color[c] * scale;
}

// The inverse of compress.
template <class Real>
void expand(Real color[3]) {
  const Real scale = Real(1.0f) / (Real(1.0f) - luminance(color));
  for (int c = 0; c < 3; ++c) color[c] = color[c] * scale;
}

}  // namespace beampipe
