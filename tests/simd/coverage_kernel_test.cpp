#include "simd/coverage.h"
#include "tests/simd/coverage_cases.h"
#include "tests/simd/every_target.h"

namespace beampipe::coverage_kernel_test {

template <class Row>
void expect_same_bits(const Row& found, const Row& expected, std::size_t i) {
  using Bits = std::array<std::uint32_t, sizeof(Row) / sizeof(std::uint32_t)>;
  ASSERT_EQ(std::bit_cast<Bits>(found), std::bit_cast<Bits>(expected)) << "triangle " << i;
}

// Both kernels, coverage and depth range, on random triangles and on those whose vertices lie on a lattice through the
// pixel's corners and the middles of its sides: edges run along the pixel's border, and triangles touch it in a point
// or along a side.
TEST(CoverageKernel, EveryTargetEqualsTheFormula) {
  Random random(1);
  std::vector<Triangle> triangles;
  for (int i = 0; i < 50'000; ++i) triangles.push_back(random_triangle(random));
  constexpr std::int64_t kAt[] = {-256, 0, 128, 256, 512};
  const auto point = [&](std::size_t i) { return Corner{kAt[i % 5], kAt[i / 5]}; };
  for (std::size_t i = 0; i < 25; ++i)
    for (std::size_t j = i + 1; j < 25; ++j)
      for (std::size_t k = j + 1; k < 25; ++k) {
        const Triangle t{{point(i), point(j), point(k)}, {-0.0f, -0.5f, -1.0f}};
        if (t.area2() != 0) triangles.push_back(oriented(t));
      }
  std::vector<TriangleInPixel> in;
  std::vector<DepthRangeInput<float>> ranges_in;
  for (const Triangle& t : triangles) in.push_back(kernel_input(t)), ranges_in.push_back(depth_range_input(t));
  on_every_target([&] {
    std::vector<Coverage<float>> out(in.size());
    std::vector<DepthRange<float>> ranges(in.size());
    coverage(in.data(), in.size(), out.data());
    depth_range(ranges_in.data(), in.size(), ranges.data());
    for (std::size_t i = 0; i < in.size(); ++i) {
      expect_same_bits(out[i], coverage_on_float(triangles[i]), i);
      expect_same_bits(ranges[i], depth_range_formula(ranges_in[i]), i);
    }
  });
}

// Batches that do not fill the last vector. Nothing may be written past their end.
TEST(CoverageKernel, EveryTargetEqualsTheFormulaForEveryBatchSize) {
  Random random(2);
  std::vector<Triangle> triangles;
  std::vector<TriangleInPixel> in;
  std::vector<DepthRangeInput<float>> ranges_in;
  for (int i = 0; i < 40; ++i) {
    triangles.push_back(random_triangle(random));
    in.push_back(kernel_input(triangles.back()));
    ranges_in.push_back(depth_range_input(triangles.back()));
  }
  on_every_target([&] {
    for (std::size_t count = 0; count < in.size(); ++count) {
      const Coverage<float> untouched{-7, -7, -7};
      const DepthRange<float> no_range{-7, -7};
      std::vector<Coverage<float>> out(in.size(), untouched);
      std::vector<DepthRange<float>> ranges(in.size(), no_range);
      coverage(in.data(), count, out.data());
      depth_range(ranges_in.data(), count, ranges.data());
      for (std::size_t i = 0; i < in.size(); ++i) {
        expect_same_bits(out[i], i < count ? coverage_on_float(triangles[i]) : untouched, i);
        expect_same_bits(ranges[i], i < count ? depth_range_formula(ranges_in[i]) : no_range, i);
      }
    }
  });
}

}  // namespace beampipe::coverage_kernel_test
