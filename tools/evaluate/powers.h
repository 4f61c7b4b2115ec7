// Logarithms and powers with the same bits on every machine, which those of the C library do not promise.
//
// They are IEEE arithmetic of doubles in a fixed order, without branches, so that a compiler can work on several
// numbers at once.
#pragma once

#include <bit>
#include <cstdint>

namespace beampipe {

inline constexpr double kLn2 = 0.69314718055994531;

// The binary logarithm of a normal positive number. The absolute error is below 1e-13 for numbers in 1e-10..1e10.
//
// x = m 2^e with m in sqrt(1/2)..sqrt(2), and ln m = 2 (t + t^3/3 + t^5/5 + ...) with t = (m - 1) / (m + 1). As |t| is
// at most 0.1716, what is left out after t^15/15 is below 2e-14.
inline double log2_of(double x) {
  constexpr std::uint64_t kSqrtHalf = 0x3FE6A09E667F3BCD, kOne = 0x3FF0000000000000;
  const auto bits = std::bit_cast<std::uint64_t>(x);
  const std::uint64_t exponent = (bits + (kOne - kSqrtHalf)) >> 52;  // e + 1023
  const auto m = std::bit_cast<double>(bits - (exponent << 52) + kOne);
  const double e = std::bit_cast<double>(exponent | 0x4330000000000000) - (0x1p52 + 1023);
  const double t = (m - 1) / (m + 1), u = t * t;
  double sum = 1.0 / 15;
  sum = sum * u + 1.0 / 13;
  sum = sum * u + 1.0 / 11;
  sum = sum * u + 1.0 / 9;
  sum = sum * u + 1.0 / 7;
  sum = sum * u + 1.0 / 5;
  sum = sum * u + 1.0 / 3;
  sum = sum * u + 1;
  return e + (2 / kLn2) * t * sum;
}

// 2^y for y in -1022..1023. The relative error is below 2e-14: the Taylor series of e^z for |z| up to ln(2) / 2 is left
// after z^11 / 11!, where 7e-15 are missing.
inline double exp2_of(double y) {
  constexpr double kRounding = 0x1.8p52;  // has the nearest whole number of y in its lowest bits when y is added
  const double shifted = y + kRounding;
  const double z = (y - (shifted - kRounding)) * kLn2;
  double sum = 1.0 / 39916800;
  sum = sum * z + 1.0 / 3628800;
  sum = sum * z + 1.0 / 362880;
  sum = sum * z + 1.0 / 40320;
  sum = sum * z + 1.0 / 5040;
  sum = sum * z + 1.0 / 720;
  sum = sum * z + 1.0 / 120;
  sum = sum * z + 1.0 / 24;
  sum = sum * z + 1.0 / 6;
  sum = sum * z + 1.0 / 2;
  sum = sum * z + 1;
  sum = sum * z + 1;
  return std::bit_cast<double>(std::bit_cast<std::uint64_t>(sum) + (std::bit_cast<std::uint64_t>(shifted) << 52));
}

// x^y for y > 0; 0 for x <= 0. The relative error is below 1e-12 for x in 1e-10..1e10 and y up to 3.
inline double power(double x, double y) {
  const double result = exp2_of(y * log2_of(x));
  return x > 0 ? result : 0.0;
}

// The encoding of linear light in images (IEC 61966-2-1), clamped to 0..1.
inline double srgb_of_linear(double linear) {
  const double light = linear < 0 ? 0.0 : linear > 1 ? 1.0 : linear;
  const double bright = 1.055 * power(light, 1 / 2.4) - 0.055;
  return light <= 0.0031308 ? 12.92 * light : bright;
}

}  // namespace beampipe
