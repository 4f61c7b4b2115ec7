// Scalar formulas on numbers that count: the counts are those that a reader finds in the code.
#include "stages/cost/counting.h"

#include "simd/sample_mask.h"
#include "tests/test.h"

namespace beampipe::counting_test {

using Real = Counted<float>;
using Bits = Counted<std::uint32_t>;

TEST(Counting, EachOperatorCountsAsItsKind) {
  OperationCounts counts;
  const Real x(3.0f, counts), y(2.0f);  // y is a constant
  const Bits m(6u, counts), n(3u, counts);
  EXPECT_EQ((x + y).value, 5.0f);
  EXPECT_EQ((y - x).value, -1.0f);
  EXPECT_TRUE(x > y);
  EXPECT_EQ(lesser(x, y).value, 2.0f);
  EXPECT_EQ(greater(x, y).value, 3.0f);
  EXPECT_EQ(select(false, x, y).value, 2.0f);
  EXPECT_EQ(counts, (OperationCounts{.add = 6}));
  EXPECT_EQ((x * y).value, 6.0f);
  EXPECT_EQ((x / y).value, 1.5f);
  EXPECT_EQ((m & n).value, 2u);
  EXPECT_EQ((m | ~n).value, 6u | ~3u);
  EXPECT_EQ(bit_count(m).value, 2.0f);
  EXPECT_EQ(counts, (OperationCounts{.mul_add = 1, .add = 6, .bit = 4, .special = 1, .convert = 1}));
}

TEST(Counting, ConstantsCostNothing) {
  OperationCounts counts;
  const Real one(1.0f), two = one + one;
  EXPECT_EQ(counts, OperationCounts{});
  EXPECT_EQ((two * Real(3.0f, counts)).value, 6.0f);
  EXPECT_EQ(counts.total(), 1u);
}

// Per sample and edge, a x + b y + c >= 0: 2 products, 2 sums, a comparison, all with 64 bits.
TEST(Counting, SampleTest) {
  const OperationCounts counts = count_operations([](OperationCounts& tally) {
    using Int = Counted<std::int64_t>;
    const Int one(1, tally), edges[3] = {one, one, one};
    sample_mask_scalar(edges, edges, edges, standard_pattern(4));
  });
  EXPECT_EQ(counts, (OperationCounts{.mul_add = 4 * 3 * 2, .add = 4 * 3 * 3}));
  EXPECT_EQ(counts.wide, 4u * 3 * 5);
}

}  // namespace beampipe::counting_test
