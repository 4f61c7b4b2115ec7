// A threshold of alpha for each place of a surface, even in 0..1: a hash of the texture's coordinates in cells about as
// large as a pixel, so that it moves with the surface. Cells have two sizes, and the threshold passes from one to the
// other as the surface comes nearer.
//
// Source: Wyman and McGuire, "Hashed Alpha Testing" (I3D 2017), section 3. They hash the object's coordinates, by
// sines.
#pragma once

#include <array>
#include <cstdint>

#include "simd/scalar.h"
#include "stages/data/mix_bits.h"

namespace beampipe {

// The mean of two even values with weights 1 - share and share, made even again: its distribution function.
template <class Real>
Real made_even(const Real& mean, const Real& share) {
  const Real one(1.0f), half(0.5f);
  const Real less = lesser(share, one - share), more = one - less;
  const Real from_end = lesser(mean, one - mean);
  const Real corner = from_end * from_end * half / greater(less * more, Real(1e-6f));
  const Real middle = (from_end - half * less) / more;
  const Real even = select(from_end < less, corner, middle);
  return select(mean < half, even, one - even);
}

// Of the cell that a point lies in, with `scale` cells for each unit of the coordinates.
template <class Real>
Real cell_threshold(const std::array<Real, 2>& uv, const Real& scale) {
  const Real most(2147483520.0f);
  const auto cell = [&](const Real& x) { return bits_of(to_integer(lesser(greater(x * scale, Real() - most), most))); };
  return to_float(mix_bits(mix_bits(mix_bits(cell(uv[0])) + cell(uv[1])) + bits_of(scale)) >> 8) *
         Real(1.0f / 16777216.0f);
}

// `dx`, `dy`: how the coordinates change per pixel.
template <class Real>
Real hashed_threshold(const std::array<Real, 2>& uv, const std::array<Real, 2>& dx, const std::array<Real, 2>& dy) {
  const Real side = greater(dx[0] * dx[0] + dx[1] * dx[1], dy[0] * dy[0] + dy[1] * dy[1]);
  const Real cells = Real(1.0f) / square_root(lesser(greater(side, Real(1e-30f)), Real(1e30f)));
  using Bits = decltype(bits_of(cells));
  const Real coarse = float_of(bits_of(cells) & Bits(0x7f800000u));  // the power of two below
  const Real share = float_of((bits_of(cells) & Bits(0x007fffffu)) | Bits(0x3f800000u)) - Real(1.0f);
  const Real of_coarse = cell_threshold(uv, coarse), of_fine = cell_threshold(uv, coarse + coarse);
  return made_even(of_coarse + (of_fine - of_coarse) * share, share);
}

}  // namespace beampipe
