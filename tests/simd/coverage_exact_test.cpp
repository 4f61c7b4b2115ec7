// The formulas of coverage and depth range on float, against polygon clipping in double precision.

#include "tests/simd/coverage_cases.h"

namespace beampipe::coverage_exact_test {

constexpr double kAlphaBound = 5e-7;  // simd/coverage.h

TEST(CoverageExact, AlphaWithinTheStatedBound) {
  Random random(3);
  for (int i = 0; i < 400'000; ++i) {
    const Triangle t = random_triangle(random);
    const double error = std::abs(coverage_on_float(t).alpha - exact_coverage(t).area);
    ASSERT_LT(error, kAlphaBound) << "triangle " << i;
  }
}

// The moments are as accurate as the area, and the centroid is their quotient.
TEST(CoverageExact, CentroidWithinTheAlphaBoundOverAlpha) {
  Random random(4);
  for (int i = 0; i < 200'000; ++i) {
    const Triangle t = random_triangle(random);
    const ExactCoverage exact = exact_coverage(t);
    if (exact.area < 1e-5) continue;
    const Coverage<float> found = coverage_on_float(t);
    ASSERT_NEAR(found.centroid_u, exact.centroid_u, kAlphaBound / exact.area) << "triangle " << i;
    ASSERT_NEAR(found.centroid_v, exact.centroid_v, kAlphaBound / exact.area) << "triangle " << i;
  }
}

// The error grows with the slopes: they are rounded to float, and so are the crossings that they are multiplied by.
TEST(CoverageExact, DepthRangeWithinHalfAMillionthOfTheSlopes) {
  Random random(5);
  for (int i = 0; i < 200'000; ++i) {
    const Triangle t = random_triangle(random);
    const ExactCoverage exact = exact_coverage(t);
    if (exact.area < kAlphaBound) continue;
    const DepthRange<float> found = depth_range_formula(depth_range_input(t));
    const Slopes slopes = depth_slopes(t);
    const double bound = 5e-7 * (1 + std::abs(slopes.dzdu) + std::abs(slopes.dzdv));
    ASSERT_NEAR(found.z_min, exact.z_min, bound) << "triangle " << i;
    ASSERT_NEAR(found.z_max, exact.z_max, bound) << "triangle " << i;
  }
}

// This holds however the numbers are rounded, for slivers too.
TEST(CoverageExact, StaysWithinTheTriangleAndThePixel) {
  Random random(6);
  for (int i = 0; i < 200'000; ++i) {
    const Triangle t = random_triangle(random);
    const Coverage<float> found = coverage_on_float(t);
    ASSERT_TRUE(found.alpha >= 0 && found.alpha <= 1);
    if (found.alpha == 0) continue;
    ASSERT_TRUE(found.centroid_u >= 0 && found.centroid_u <= 1 && found.centroid_v >= 0 && found.centroid_v <= 1);
    const DepthRange<float> depth = depth_range_formula(depth_range_input(t));
    ASSERT_LE(std::min({t.z[0], t.z[1], t.z[2]}), depth.z_min);
    ASSERT_LE(depth.z_min, depth.z_max);
    ASSERT_LE(depth.z_max, std::max({t.z[0], t.z[1], t.z[2]}));
  }
}

TEST(CoverageExact, FullPixelOfAGiantTriangle) {
  const Triangle giant{{{-kLimit, -kLimit}, {kLimit, -kLimit}, {-kLimit, kLimit}}, {-1.0f, -0.5f, -0.5f}};
  const Coverage<float> found = coverage_on_float(oriented(giant), -1, -1);
  EXPECT_EQ(found.alpha, 1.0f);
  EXPECT_EQ(found.centroid_u, 0.5f);
  EXPECT_EQ(found.centroid_v, 0.5f);
}

}  // namespace beampipe::coverage_exact_test
