#include "simd/depth_span.h"

#include <gtest/gtest.h>

#include <vector>

#include "tests/simd/every_target.h"
#include "tests/simd/random.h"

namespace beampipe {
namespace {

TEST(DepthSpan, KernelEqualsTwinForEveryLength) {
  Random random(61);
  SCOPED_TRACE(random.name());
  for (std::size_t count = 0; count <= 70; ++count) {
    std::vector<double> depth(count + 8);
    for (double& z : depth) z = random.real(-1, 0);
    const std::vector<std::uint64_t> owner(depth.size(), 5);
    const DepthSpan span{random.real(-1, 0), random.real(-1, 1), random.real(-0.5, 0.5), random.real(-100, 100),
                         1.0 / 64};
    // Some depths as the span will compute them: ties.
    for (std::size_t i = 0; i < count; i += 3) {
      const double x = span.x + span.step * static_cast<double>(i);
      depth[i] = (span.z + span.dzdx * x) + span.row;
    }
    std::vector<double> expected_depth = depth;
    std::vector<std::uint64_t> expected_owner = owner;
    const std::uint64_t expected = depth_span_scalar(span, 0, count, 9, expected_depth.data(), expected_owner.data());
    on_every_target([&] {
      std::vector<double> found_depth = depth;
      std::vector<std::uint64_t> found_owner = owner;
      ASSERT_EQ(depth_span(span, count, 9, found_depth.data(), found_owner.data()), expected);
      ASSERT_EQ(found_depth, expected_depth) << count << " samples";
      ASSERT_EQ(found_owner, expected_owner) << count << " samples";
    });
  }
}

TEST(DepthSpan, NearerReplacesEqualDoesNot) {
  // Depths -0.5, -0.375, -0.25, ... against -0.25 everywhere: two are nearer, the third is equal.
  const DepthSpan span{-0.5, 0.125, 0.0, 0.0, 1.0};
  on_every_target([&] {
    std::vector<double> depth(9, -0.25);
    std::vector<std::uint64_t> owner(9, 1);
    EXPECT_EQ(depth_span(span, 9, 2, depth.data(), owner.data()), 2u);
    EXPECT_EQ(owner, (std::vector<std::uint64_t>{2, 2, 1, 1, 1, 1, 1, 1, 1}));
    EXPECT_EQ(depth[0], -0.5);
    EXPECT_EQ(depth[1], -0.375);
    EXPECT_EQ(depth[2], -0.25);
  });
}

}  // namespace
}  // namespace beampipe
