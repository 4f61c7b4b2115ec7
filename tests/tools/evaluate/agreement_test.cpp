#include "tools/evaluate/agreement.h"

#include "tests/test.h"

namespace beampipe::agreement_test {

// Errors of 1, 0 and 1/2 of what was measured; ratios of 2, 1 and 1/2, whose logarithms have the variance ln(2)^2.
TEST(Agreement, FollowsFromRatios) {
  const Agreement of = agreement_of({{1, 2}, {2, 2}, {4, 2}});
  EXPECT_EQ(of.count, 3u);
  EXPECT_NEAR(of.mape.value(), 0.5, 1e-12);
  EXPECT_NEAR(of.geometric_mean.value(), 1, 1e-12);
  EXPECT_NEAR(of.spread.value(), 2, 1e-12);
  EXPECT_FALSE(of.spearman) << "modelled numbers that are all equal have no order";
}

// Ranks 0, 1.5, 1.5, 3 and 0, 2, 1, 3: 4.5 / sqrt(4.5 * 5).
TEST(Agreement, EqualNumbersShareTheirMeanRank) {
  EXPECT_NEAR(agreement_of({{1, 10}, {2, 30}, {2, 20}, {4, 1e6}}).spearman.value(), std::sqrt(0.9), 1e-12);
  EXPECT_NEAR(agreement_of({{1e-6, 3}, {2, 2}, {1e6, 1}}).spearman.value(), -1, 1e-12);
  EXPECT_NEAR(agreement_of({{3, 5}, {1, 1}}).spearman.value(), 1, 1e-12);
}

TEST(Agreement, FewNumbersSayLess) {
  const Agreement none = agreement_of({});
  EXPECT_EQ(none.count, 0u);
  EXPECT_FALSE(none.mape || none.geometric_mean || none.spread || none.spearman);
  const Agreement one = agreement_of({{4, 3}});
  EXPECT_NEAR(one.mape.value(), 0.25, 1e-12);
  EXPECT_NEAR(one.geometric_mean.value(), 0.75, 1e-12);
  EXPECT_FALSE(one.spread || one.spearman);
}

}  // namespace beampipe::agreement_test
