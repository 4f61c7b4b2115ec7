#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cstdint>
#include <vector>

#include "simd/coverage.h"
#include "tests/simd/coverage_cases.h"
#include "tests/simd/every_target.h"

namespace beampipe {
namespace {

using Bits = std::array<std::uint32_t, sizeof(Coverage<float>) / sizeof(std::uint32_t)>;

void expect_kernel_equals_twin(const std::vector<CoverageInput<float>>& in) {
  on_every_target([&] {
    std::vector<Coverage<float>> out(in.size());
    coverage(in.data(), in.size(), out.data());
    for (std::size_t i = 0; i < in.size(); ++i)
      ASSERT_EQ(std::bit_cast<Bits>(out[i]), std::bit_cast<Bits>(coverage_scalar(in[i]))) << "triangle " << i;
  });
}

TEST(CoverageKernel, EqualsTwinOnRandomTriangles) {
  Random random(1);
  SCOPED_TRACE(random.name());
  std::vector<CoverageInput<float>> in;
  for (int i = 0; i < 50'000; ++i) in.push_back(coverage_input(random_triangle(random)));
  expect_kernel_equals_twin(in);
}

// Vertices on a lattice through the pixel's corners and middles: edges along borders, touches in a point or along a
// side.
TEST(CoverageKernel, EqualsTwinOnTouches) {
  std::vector<CoverageInput<float>> in;
  constexpr std::int64_t kAt[] = {-256, 0, 128, 256, 512};
  const auto point = [&](std::size_t i) { return Corner{kAt[i % 5], kAt[i / 5]}; };
  for (std::size_t i = 0; i < 25; ++i)
    for (std::size_t j = i + 1; j < 25; ++j)
      for (std::size_t k = j + 1; k < 25; ++k) {
        const Triangle t{{point(i), point(j), point(k)}, {-0.0f, -0.5f, -1.0f}};
        if (t.area2() != 0) in.push_back(coverage_input(oriented(t)));
      }
  expect_kernel_equals_twin(in);
}

// Batches that do not fill the last vector, and nothing written past their end.
TEST(CoverageKernel, EqualsTwinForEveryBatchSize) {
  Random random(2);
  SCOPED_TRACE(random.name());
  std::vector<CoverageInput<float>> in;
  for (int i = 0; i < 40; ++i) in.push_back(coverage_input(random_triangle(random)));
  on_every_target([&] {
    for (std::size_t count = 0; count < in.size(); ++count) {
      const Coverage<float> untouched{-7, -7, -7, -7, -7};
      std::vector<Coverage<float>> out(in.size(), untouched);
      coverage(in.data(), count, out.data());
      for (std::size_t i = 0; i < in.size(); ++i) {
        const Coverage<float> expected = i < count ? coverage_scalar(in[i]) : untouched;
        ASSERT_EQ(std::bit_cast<Bits>(out[i]), std::bit_cast<Bits>(expected)) << "triangle " << i << " of " << count;
      }
    }
  });
}

}  // namespace
}  // namespace beampipe
