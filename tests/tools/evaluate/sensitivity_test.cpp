#include "tools/evaluate/sensitivity.h"

#include "tests/test.h"

namespace beampipe::sensitivity_test {

Hardware with_ranges() {
  Hardware hardware;
  hardware.rates = {{"exact", 5}, {"narrow", 10}, {"wide", 100}};
  hardware.ranges = {{"narrow", {10, 10}}, {"wide", {1, 10000}}};
  return hardware;
}

// Half of the draws from 1..10000 are below 100, the geometric mean, and a quarter below 10.
TEST(Sensitivity, RatesAreDrawnFromTheirRanges) {
  const std::vector<Hardware> draws = drawn_hardware(with_ranges(), 1000);
  ASSERT_EQ(draws.size(), 1000u);
  int below_10 = 0, below_100 = 0;
  for (const Hardware& draw : draws) {
    EXPECT_EQ(draw.rates.at("exact"), 5);
    EXPECT_DOUBLE_EQ(draw.rates.at("narrow"), 10);
    EXPECT_GE(draw.rates.at("wide"), 1);
    EXPECT_LE(draw.rates.at("wide"), 10000);
    below_10 += draw.rates.at("wide") < 10;
    below_100 += draw.rates.at("wide") < 100;
  }
  EXPECT_NEAR(below_10, 250, 60);
  EXPECT_NEAR(below_100, 500, 60);
  EXPECT_EQ(drawn_hardware(with_ranges(), 1000).back().rates, draws.back().rates) << "the same in every run";
}

TEST(Sensitivity, NineTenthsAreInTheMiddle) {
  std::vector<double> values;
  for (int i = 100; i >= 1; --i) values.push_back(i);
  EXPECT_EQ(middle_of(values).low, 5);
  EXPECT_EQ(middle_of(values).high, 96);
  EXPECT_EQ(middle_of({3}).low, 3);
  EXPECT_EQ(middle_of({3}).high, 3);
}

TEST(Sensitivity, EachRateAloneGoesToItsEnds) {
  const std::vector<RateEnds> ends = ends_of_ranges(with_ranges());
  ASSERT_EQ(ends.size(), 2u);
  EXPECT_EQ(ends[1].rate, "wide");
  EXPECT_EQ(ends[1].low.rates, (std::map<std::string, double>{{"exact", 5}, {"narrow", 10}, {"wide", 1}}));
  EXPECT_EQ(ends[1].high.rates, (std::map<std::string, double>{{"exact", 5}, {"narrow", 10}, {"wide", 10000}}));
}

}  // namespace beampipe::sensitivity_test
