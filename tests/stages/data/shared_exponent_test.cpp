#include "stages/data/shared_exponent.h"

#include "tests/simd/random.h"

namespace beampipe::shared_exponent_test {

// Every channel is within a step of the colour's exponent, whatever the threshold.
void expect_close(const glm::vec3& color, float threshold) {
  const glm::vec3 kept = SharedExponent(color, threshold);
  const float largest = std::max({color[0], color[1], color[2]});
  for (int c = 0; c < 3; ++c) {
    EXPECT_LE(std::abs(kept[c] - color[c]), largest / 127) << color[0] << ' ' << color[1] << ' ' << color[2];
    EXPECT_GE(kept[c], 0.0f);
  }
}

TEST(SharedExponent, IsCloseToTheColor) {
  Random random(211);
  for (int i = 0; i < 20'000; ++i) {
    const float scale = std::pow(10.0f, random.real32(-6, 6));
    const glm::vec3 color = scale * glm::vec3(random.real32(0, 1), random.real32(0, 1), random.real32(0, 1));
    for (const float threshold : {0x1p-8f, 0.5f, 1.0f}) expect_close(color, threshold);
  }
  for (int power = -20; power <= 20; ++power) {
    const float exact = std::ldexp(1.0f, power);
    for (const float value : {exact, std::nextafter(exact, 0.0f), std::nextafter(exact, 1e30f), exact * 255 / 256})
      for (const float threshold : {0x1p-8f, 0.5f, 1.0f}) expect_close({value, value / 3, 0.0f}, threshold);
  }
}

TEST(SharedExponent, NegativeChannelsBecomeBlack) {
  const glm::vec3 kept = SharedExponent({1.0f, -0.5f, -1e30f}, 0.5f);
  EXPECT_EQ(kept, glm::vec3(1, 0, 0));
  EXPECT_EQ(glm::vec3(SharedExponent({-1.0f, -2.0f, -3.0f}, 0.5f)), glm::vec3(0.0f));
}

TEST(SharedExponent, BlackIsExact) {
  EXPECT_EQ(glm::vec3(SharedExponent(glm::vec3(0.0f), 0x1p-8f)), glm::vec3(0.0f));
  EXPECT_EQ(glm::vec3(SharedExponent()), glm::vec3(0.0f));
}

// A mean that takes up many small parts of another colour arrives at the true mean, because thresholds differ. With one
// threshold it would stay where it was.
TEST(SharedExponent, AMeanMovesByManySmallSteps) {
  Random random(212);
  double error = 0;
  constexpr int kRuns = 200;
  for (int run = 0; run < kRuns; ++run) {
    glm::vec3 mean(0.5f);
    double exact = 0.5;
    for (int k = 1; k < 256; ++k) {
      const float other = 0.5f + 0.4f * static_cast<float>(k) / 255;
      exact += (other - exact) / (k + 1);
      const auto part = 1.0f / static_cast<float>(k + 1);
      mean = SharedExponent((1 - part) * mean + part * glm::vec3(other), random.real32(0x1p-8, 1));
    }
    error += mean[0] - exact;
  }
  EXPECT_LT(std::abs(error / kRuns), 0.004);
}

}  // namespace beampipe::shared_exponent_test
