// What the tests share: the driver, and cases of random numbers.
#pragma once

#include "tests/lavapipe/executor_run.h"
#include "tests/stages/spirv/shader_text.h"

namespace beampipe {

class LavapipeTest : public testing::Test {
 protected:
  static void SetUpTestSuite() { driver_ = Driver::find(problem_).release(); }
  static void TearDownTestSuite() { delete driver_; }
  void SetUp() override {
    if (!driver_) GTEST_SKIP() << problem_;
  }

  static std::uint32_t bits_of(float value) { return std::bit_cast<std::uint32_t>(value); }
  float uniform(float least, float most) { return std::uniform_real_distribution<float>(least, most)(random_); }

  // The inputs of shader_text(): %a, %b, %c within [least, most], and any %i, %j, %k.
  ShaderCase points(const ShaderParts& parts, float least = -10, float most = 10) {
    ShaderCase made{.words = assembled(shader_text(parts))};
    for (std::uint32_t location = 0; location < 6; ++location) {
      CaseInput& input = made.inputs[location];
      input.is_integer = location >= 3;
      input.vertices.resize(kPixels);
      for (std::size_t i = 0; i < kPixels; ++i)
        for (std::uint32_t& bits : input.vertices[i])
          bits = input.is_integer ? any_integer(random_, i) : bits_of(uniform(least, most));
    }
    return made;
  }
  // A triangle: %a, %b and %c are linear, of multiples of 1/64, so that both know them exactly.
  ShaderCase triangle(const ShaderParts& parts) {
    ShaderCase made{.words = assembled(shader_text(parts)), .is_triangle = true};
    for (std::uint32_t location = 0; location < 6; ++location) {
      CaseInput& input = made.inputs[location];
      input.is_integer = location >= 3;
      input.vertices.resize(3);
      for (FourBits& vertex : input.vertices)
        for (std::uint32_t& bits : vertex)
          bits = input.is_integer ? any_integer(random_, 3) : bits_of(std::nearbyint(uniform(-256, 256)) / 64);
    }
    return made;
  }

  void expect_near(const ShaderCase& shader, const std::string& name, double tolerance = 1e-5) {
    const Agreement found = agreement_of(*driver_, shader, tolerance);
    EXPECT_GT(found.outputs, 0u) << name;
    EXPECT_EQ(found.near, found.outputs) << name << "\n" << found.example << ", worst " << found.worst;
  }

  static inline Driver* driver_ = nullptr;
  static inline std::string problem_;
  std::mt19937 random_{7};
};

}  // namespace beampipe
