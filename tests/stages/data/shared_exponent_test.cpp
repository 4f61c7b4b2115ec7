#include "stages/data/shared_exponent.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/simd/random.h"

namespace beampipe {
namespace {

void expect_close(const glm::vec3& color) {
  const glm::vec3 kept = SharedExponent(color);
  const double largest = std::max({color[0], color[1], color[2]});
  for (int c = 0; c < 3; ++c) {
    ASSERT_GE(kept[c], 0.0f);
    ASSERT_LE(std::abs(double{kept[c]} - color[c]), largest / 255) << color[0] << " " << color[1] << " " << color[2];
  }
}

TEST(SharedExponent, IsAsExactAsItsLargestChannel) {
  Random random(211);
  SCOPED_TRACE(random.name());
  for (int i = 0; i < 100'000; ++i) {
    const auto brightness = static_cast<float>(std::pow(10.0, random.real(-6, 6)));
    glm::vec3 color = brightness * glm::vec3(random.real32(0, 1), random.real32(0, 1), random.real32(0, 1));
    if (random.one_in(4)) color[static_cast<int>(random.integer(0, 2))] = 0;
    expect_close(color);
  }
}

TEST(SharedExponent, KeepsGreyBlackAndPowersOfTwo) {
  EXPECT_EQ(glm::vec3(SharedExponent(glm::vec3(0.0f))), glm::vec3(0.0f));
  EXPECT_EQ(glm::vec3(SharedExponent()), glm::vec3(0.0f));
  for (int power = -60; power <= 60; ++power) {
    const float unit = std::ldexp(1.0f, power);
    for (const glm::vec3& color : {glm::vec3(unit), glm::vec3(unit, 0, unit / 2), glm::vec3(unit / 128, unit, 0)})
      EXPECT_EQ(glm::vec3(SharedExponent(color)), color) << power;
  }
}

// Below a power of two, all eight bits of the mantissa are ones, or it takes the next exponent. It never becomes 256,
// which would be stored as 0.
TEST(SharedExponent, DoesNotOverflowBelowAPowerOfTwo) {
  for (int power = -60; power <= 60; ++power) {
    const float unit = std::ldexp(1.0f, power);
    for (int i = 0; i <= 4000; ++i) {
      const float below = unit * (1 - static_cast<float>(i) * 0x1p-19f);
      expect_close({below, 0, 0});
      expect_close({below, below / 2, below / 3});
      expect_close({0, unit * 63.5f / 256, below});
    }
    expect_close(glm::vec3(std::nextafter(unit, 0.0f)));
    expect_close(glm::vec3(std::nextafter(unit, 1e30f)));
  }
}

// What is kept is kept again without a change, so merging black does not darken a colour.
TEST(SharedExponent, IsStable) {
  Random random(212);
  SCOPED_TRACE(random.name());
  for (int i = 0; i < 10'000; ++i) {
    const glm::vec3 once = SharedExponent(glm::vec3(random.real32(0, 2), random.real32(0, 2), random.real32(0, 2)));
    ASSERT_EQ(glm::vec3(SharedExponent(once)), once);
  }
}

}  // namespace
}  // namespace beampipe
