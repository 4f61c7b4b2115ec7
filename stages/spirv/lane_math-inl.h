// Functions of one number, without the C library, whose results have other bits on other machines. They are computed in
// double precision from series, and rounded once. Included once per SIMD target.
//
// Errors: sin, cos, tan, asin, acos, atan, atan2, exp, exp2, log, log2 and pow are within 0.51 units in the last place
// of the float that is nearest to the true value, sinh, cosh, tanh, asinh, acosh and atanh within 0.6. sin, cos and tan
// take numbers up to 2^30 in magnitude; larger ones count as 0.
#if defined(BEAMPIPE_SPIRV_LANE_MATH_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef BEAMPIPE_SPIRV_LANE_MATH_INL_H_
#undef BEAMPIPE_SPIRV_LANE_MATH_INL_H_
#else
#define BEAMPIPE_SPIRV_LANE_MATH_INL_H_
#endif

#include <bit>
#include <cmath>
#include <cstdint>

#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace beampipe {
namespace HWY_NAMESPACE {
namespace lane_math {

constexpr double kPi = 3.14159265358979323846, kLn2 = 0.69314718055994530942;

// The nearest whole number, as a double and, modulo 2^32, in `bits`: beyond 2^52 a double has no places for less.
HWY_INLINE double nearest(double x, std::uint32_t& bits) {
  constexpr double kShift = 0x1.8p52;
  const double shifted = x + kShift;
  bits = static_cast<std::uint32_t>(std::bit_cast<std::uint64_t>(shifted));
  return shifted - kShift;
}

// Taylor's series, for |x| <= pi / 4: the first terms that are left out are below 1e-11 of the value.
HWY_INLINE double sine_series(double x) {
  const double s = x * x;
  return x * (1 + s * (-1.0 / 6 + s * (1.0 / 120 + s * (-1.0 / 5040 + s * (1.0 / 362880 + s * (-1.0 / 39916800))))));
}
HWY_INLINE double cosine_series(double x) {
  const double s = x * x;
  return 1 + s * (-1.0 / 2 +
                  s * (1.0 / 24 + s * (-1.0 / 720 + s * (1.0 / 40320 + s * (-1.0 / 3628800 + s * (1.0 / 479001600))))));
}

// sin(x + quarters * pi / 2), from x less the nearest multiple of pi / 2, which is subtracted in three parts.
struct Turned {
  double sine, cosine;
};
HWY_INLINE Turned turned(float x) {
  // pi / 2 is their sum; products of the first two with whole numbers below 2^30 are exact.
  constexpr double kHigh = 0x1.921fb4p0, kMiddle = 0x1.4442dp-24, kLow = 0x1.8469898cc517p-48;
  const double angle = x < 0x1p30f && x > -0x1p30f ? static_cast<double>(x) : static_cast<double>(x) * 0;
  std::uint32_t quarters;
  const double turns = nearest(angle * (2 / kPi), quarters);
  const double rest = ((angle - turns * kHigh) - turns * kMiddle) - turns * kLow;
  const double sine = sine_series(rest), cosine = cosine_series(rest);
  const bool swaps = (quarters & 1) != 0, negates = (quarters & 2) != 0;
  const double first = swaps ? cosine : sine, second = swaps ? -sine : cosine;
  return {negates ? -first : first, negates ? -second : second};
}
HWY_INLINE float sin(float x) { return static_cast<float>(turned(x).sine); }
HWY_INLINE float cos(float x) { return static_cast<float>(turned(x).cosine); }
HWY_INLINE float tan(float x) {
  const Turned at = turned(x);
  return static_cast<float>(at.sine / at.cosine);
}

// 2^x; |x| beyond 1000 counts as 1000, which no float can tell apart.
HWY_INLINE double power_of_2(double x) {
  x = x < -1000.0 ? -1000.0 : x;
  x = x > 1000.0 ? 1000.0 : x;
  std::uint32_t whole;
  const double rest = (x - nearest(x, whole)) * kLn2;
  const double series =
      1 + rest * (1 + rest * (1.0 / 2 +
                              rest * (1.0 / 6 +
                                      rest * (1.0 / 24 +
                                              rest * (1.0 / 120 +
                                                      rest * (1.0 / 720 + rest * (1.0 / 5040 +
                                                                                  rest * (1.0 / 40320 +
                                                                                          rest * (1.0 / 362880)))))))));
  const std::uint64_t exponent =
      static_cast<std::uint64_t>(static_cast<std::int64_t>(static_cast<std::int32_t>(whole)) + 1023);
  return series * std::bit_cast<double>(exponent << 52);
}
HWY_INLINE float exp2(float x) { return static_cast<float>(power_of_2(x)); }
HWY_INLINE float exp(float x) { return static_cast<float>(power_of_2(x * (1 / kLn2))); }

// The logarithm to base 2 of a number that is a normal double, or its limit.
HWY_INLINE double logarithm_to_2(double x) {
  const std::uint64_t bits = std::bit_cast<std::uint64_t>(x);
  const double mantissa = std::bit_cast<double>((bits & 0xfffffffffffffu) | 0x3ff0000000000000u);  // 1..2
  const bool is_large = mantissa > 1.4142135623730951;
  const double m = is_large ? mantissa * 0.5 : mantissa;
  // Without a conversion of 64-bit integers: the exponent stands in the last places of 2^52.
  const double exponent =
      std::bit_cast<double>(bits >> 52 | 0x4330000000000000u) - (0x1p52 + (is_large ? 1022.0 : 1023.0));
  const double s = (m - 1) / (m + 1), q = s * s;
  const double series =
      1 +
      q * (1.0 / 3 + q * (1.0 / 5 + q * (1.0 / 7 + q * (1.0 / 9 + q * (1.0 / 11 + q * (1.0 / 13 + q * (1.0 / 15)))))));
  const double logarithm = exponent + s * series * (2 / kLn2);
  constexpr double kInfinity = HUGE_VAL;
  const double below = x < 0 ? std::bit_cast<double>(0x7ff8000000000000u) : -kInfinity;
  const double finite = x > 0 ? logarithm : below;
  return x < kInfinity ? finite : x;  // infinity, or what is no number
}
HWY_INLINE float log2(float x) { return static_cast<float>(logarithm_to_2(x)); }
HWY_INLINE float log(float x) { return static_cast<float>(logarithm_to_2(x) * kLn2); }
// Of x >= 0, as GLSL has it; x^0 is 1.
HWY_INLINE float pow(float x, float y) {
  const float power = static_cast<float>(power_of_2(y * logarithm_to_2(x)));
  return y == 0 ? 1.0f : power;
}

// The angle, 0..pi/4, whose tangent is x, 0..1: the half angle of a half angle has a short series.
HWY_INLINE double angle_of(double x) {
  const double half = x / (1 + std::sqrt(1 + x * x)), quarter = half / (1 + std::sqrt(1 + half * half));
  const double q = quarter * quarter;
  return 4 * quarter *
         (1 + q * (-1.0 / 3 + q * (1.0 / 5 + q * (-1.0 / 7 + q * (1.0 / 9 + q * (-1.0 / 11 + q * (1.0 / 13)))))));
}
// The angle of the point (x, y), -pi..pi. 0 for (0, 0).
HWY_INLINE double angle_of(double y, double x) {
  const double across = std::fabs(x), up = std::fabs(y);
  const bool is_steep = up > across;
  const double longer = is_steep ? up : across, shorter = is_steep ? across : up;
  const double ratio = longer == 0 ? 0 : shorter == longer ? 1 : shorter / longer;
  const double low = angle_of(ratio), first = is_steep ? kPi / 2 - low : low;
  const double angle = x < 0 ? kPi - first : first;
  return std::copysign(angle, y);
}
HWY_INLINE float atan(float x) { return static_cast<float>(angle_of(x, 1)); }
HWY_INLINE float atan2(float y, float x) { return static_cast<float>(angle_of(y, x)); }
HWY_INLINE float asin(float x) {
  const double d = x;
  return static_cast<float>(angle_of(d, std::sqrt((1 - d) * (1 + d))));
}
HWY_INLINE float acos(float x) {
  const double d = x;
  return static_cast<float>(angle_of(std::sqrt((1 - d) * (1 + d)), d));
}

HWY_INLINE float sinh(float x) {
  const double d = x, power = power_of_2(d * (1 / kLn2)), q = d * d;
  const double series =
      d * (1 + q * (1.0 / 6 + q * (1.0 / 120 + q * (1.0 / 5040 + q * (1.0 / 362880 + q * (1.0 / 39916800))))));
  return static_cast<float>(q < 0.25 ? series : (power - 1 / power) * 0.5);
}
HWY_INLINE float cosh(float x) {
  const double power = power_of_2(x * (1 / kLn2));
  return static_cast<float>((power + 1 / power) * 0.5);
}
HWY_INLINE float tanh(float x) {
  const double d = x < -20.0f ? -20.0 : x > 20.0f ? 20.0 : static_cast<double>(x);
  const double square = power_of_2(d * (2 / kLn2)), q = d * d;
  const double series =
      d * (1 + q * (-1.0 / 3 + q * (2.0 / 15 + q * (-17.0 / 315 + q * (62.0 / 2835 + q * (-1382.0 / 155925))))));
  return static_cast<float>(q < 0.0025 ? series : (square - 1) / (square + 1));
}
HWY_INLINE float asinh(float x) {
  const double d = std::fabs(static_cast<double>(x));
  const double whole = logarithm_to_2(d + std::sqrt(d * d + 1)) * kLn2;
  return static_cast<float>(std::copysign(d < 1e-4 ? d : whole, static_cast<double>(x)));
}
HWY_INLINE float acosh(float x) {
  const double d = x, above = d - 1;  // exact
  return static_cast<float>(logarithm_to_2(1 + (above + std::sqrt(above * (d + 1)))) * kLn2);
}
HWY_INLINE float atanh(float x) {
  const double d = x;
  const double whole = logarithm_to_2((1 + d) / (1 - d)) * (kLn2 / 2);
  return static_cast<float>(std::fabs(d) < 1e-4 ? d : whole);
}

}  // namespace lane_math
}  // namespace HWY_NAMESPACE
}  // namespace beampipe
HWY_AFTER_NAMESPACE();

#endif
