#include "simd/depth_span.h"

#include "tests/simd/every_target.h"
#include "tests/simd/random.h"

namespace beampipe::depth_span_test {

// On small multiples of powers of two double arithmetic is exact, and so is integer arithmetic.
TEST(DepthSpan, EqualsIntegerArithmetic) {
  Random random(62);
  int ties = 0;
  on_every_target([&] {
    for (int draw = 0; draw < 2'000; ++draw) {
      // In 1/64: z, row and stored depths. In 1/8: slope, x and step.
      const std::int64_t z = random.integer(-64, 0), row = random.integer(-9, 9), slope = random.integer(-8, 8),
                         x = random.integer(-30, 30), step = random.integer(1, 3);
      const DepthSpan span{static_cast<double>(z) / 64, static_cast<double>(slope) / 8, static_cast<double>(row) / 64,
                           static_cast<double>(x) / 8, static_cast<double>(step) / 8};
      std::vector<std::int64_t> stored(static_cast<std::size_t>(random.integer(1, 40)));
      std::vector<double> depth;
      for (std::int64_t& value : stored) depth.push_back(static_cast<double>(value = random.integer(-90, 20)) / 64);
      std::vector<std::uint64_t> owner(stored.size(), 1);
      const std::uint64_t passed = depth_span(span, stored.size(), 2, depth.data(), owner.data());
      std::uint64_t expected = 0;
      for (std::size_t i = 0; i < stored.size(); ++i) {
        const std::int64_t at = z + slope * (x + step * static_cast<std::int64_t>(i)) + row;
        const bool nearer = at < stored[i];
        expected += nearer, ties += at == stored[i];
        ASSERT_EQ(depth[i] * 64, static_cast<double>(nearer ? at : stored[i])) << "draw " << draw << ", sample " << i;
        ASSERT_EQ(owner[i], nearer ? 2u : 1u) << "draw " << draw << ", sample " << i;
      }
      ASSERT_EQ(passed, expected);
    }
  });
  EXPECT_GT(ties, 100);
}

}  // namespace beampipe::depth_span_test
