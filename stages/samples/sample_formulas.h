// The formulas of the stages that work on samples, for numbers and for numbers that count (stages/cost/counting.h).
#pragma once

#include "simd/scalar.h"
#include "stages/data/fragment_geometry.h"

namespace beampipe {

// ---- accumulate; colours and sums are R, G, B, A ----

// Adds color x share to the sum. With `saturate`, the share is at most what alpha lacks to `limit`.
template <class Real>
void add_weighted(const Real color[4], Real share, bool saturate, Real limit, Real sum[4]) {
  if (saturate) share = greater(lesser(share, limit - sum[3]), Real(0.0f));
  for (int c = 0; c < 4; ++c) sum[c] = sum[c] + color[c] * share;
}

// Converts a sum to the accumulator's format or from it.
template <class Real>
void convert_sum(Real sum[4]) {
  for (int c = 0; c < 4; ++c) sum[c] = converted(sum[c]);
}

// Blends a sum over the background, which shows as far as alpha leaves it.
template <class Real>
void sum_over_background(const Real sum[4], const Real background[3], Real pixel[3]) {
  const Real left = greater(Real(1.0f) - sum[3], Real(0.0f));
  for (int c = 0; c < 3; ++c) pixel[c] = sum[c] + background[c] * left;
}

// ---- dilate ----

// Sets the weights of a quad's shading samples in a pixel, and returns their sum. A weight is the number of the pixel's
// visibility samples that the shading sample was given; `base` has the bits of the pixel.
template <class Bits, class Real>
Real weigh(const Bits masks[], int samples, Bits base, Real weights[]) {
  Real sum = weights[0] = bit_count(masks[0] & base);
  for (int i = 1; i < samples; ++i) {
    weights[i] = bit_count(masks[i] & base);
    sum = sum + weights[i];
  }
  return sum;
}

// `inverse`: 1 / the sum of the weights.
template <class Real>
Real weighted_mean(const Real values[], const Real weights[], int samples, Real inverse) {
  Real sum = values[0] * weights[0];
  for (int i = 1; i < samples; ++i) sum = sum + values[i] * weights[i];
  return sum * inverse;
}

// Extends the box by a neighbour's colour if it belongs to the same draw.
template <class Real>
void grow_box(const Real color[4], bool same_draw, Real low[4], Real high[4]) {
  for (int c = 0; c < 4; ++c) {
    low[c] = lesser(low[c], select(same_draw, color[c], low[c]));
    high[c] = greater(high[c], select(same_draw, color[c], high[c]));
  }
}

// ---- shading_point ----

// Is the point inside the edge? `not_owned`: 0 if points on the edge belong to the triangle, else 1.
template <class Int>
bool is_inside(const EdgeAt<Int>& edge, Int x, Int y, Int not_owned) {
  return edge.at(x, y) >= not_owned;
}

// The mean position of the samples whose bits are set in `mask`. bits[s] is the bit of sample s, which lies at (x[s],
// y[s]), in 1/256 px from the cell's corner.
template <class Real>
struct Position {
  Real x, y;
};
template <class Bits, class Real>
Position<Real> mean_position(Bits mask, const Bits bits[], const Real x[], const Real y[], int samples) {
  const Real zero(0.0f);
  Real sum_x = zero, sum_y = zero;
  for (int s = 0; s < samples; ++s) {
    const bool covered = (mask & bits[s]) != Bits(0);
    sum_x = sum_x + select(covered, x[s], zero), sum_y = sum_y + select(covered, y[s], zero);
  }
  const Real share = Real(1.0f) / bit_count(mask);
  return {sum_x * share, sum_y * share};
}

}  // namespace beampipe
