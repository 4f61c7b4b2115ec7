#include "stages/data/half_bits.h"

#include "tests/test.h"

namespace beampipe::half_bits_test {

constexpr int kInfinity = 0x7c00;

// IEEE 754: a sign, 5 bits of exponent, 10 bits of fraction. Infinity counts as the number that would follow 65504.
double by_definition(int bits) {
  const int exponent = bits >> 10, fraction = bits & 0x3ff;
  return exponent == 0 ? std::ldexp(fraction, -24) : std::ldexp(0x400 + fraction, exponent - 25);
}

TEST(HalfBits, EachHasItsValue) {
  for (int bits = 0; bits < kInfinity; ++bits) {
    ASSERT_EQ(half_value(static_cast<std::uint16_t>(bits)), by_definition(bits)) << bits;
    ASSERT_EQ(half_value(static_cast<std::uint16_t>(bits | 0x8000)), -by_definition(bits)) << bits;
  }
  EXPECT_TRUE(std::signbit(half_value(0x8000)));
}

TEST(HalfBits, FloatsBecomeTheNearestOne) {
  for (int bits = 0; bits < kInfinity; ++bits) {
    const auto middle = static_cast<float>((by_definition(bits) + by_definition(bits + 1)) / 2);  // exact
    const int even = bits + bits % 2;
    ASSERT_EQ(half_of(static_cast<float>(by_definition(bits))), bits);
    ASSERT_EQ(half_of(std::nextafter(middle, 0.0f)), bits);
    ASSERT_EQ(half_of(middle), even);
    ASSERT_EQ(half_of(std::nextafter(middle, 1e9f)), bits + 1);
    ASSERT_EQ(half_of(-middle), even | 0x8000);
    if (even == kInfinity) continue;
    ASSERT_EQ(rounded_to_half(middle), by_definition(even));
    ASSERT_EQ(rounded_to_half(-std::nextafter(middle, 0.0f)), -by_definition(bits));
    ASSERT_EQ(rounded_to_half(std::nextafter(middle, 1e9f)), by_definition(bits + 1));
  }
}

TEST(HalfBits, WhatIsTooLargeIsInfiniteOrTheLargest) {
  EXPECT_EQ(rounded_to_half(1e9f), HalfBits::kMost);
  EXPECT_EQ(rounded_to_half(-65520.0f), -HalfBits::kMost);
  constexpr float kInfinite = std::numeric_limits<float>::infinity();
  for (const float value : {65520.0f, 1e9f, kInfinite}) {
    EXPECT_EQ(nearest_half(value), kInfinite);
    EXPECT_EQ(nearest_half(-value), -kInfinite);
    EXPECT_EQ(HalfBits(value), 65504.0f);
    EXPECT_EQ(HalfBits(-value), -65504.0f);
  }
  EXPECT_TRUE(std::isnan(nearest_half(std::numeric_limits<float>::quiet_NaN())));
}

}  // namespace beampipe::half_bits_test
