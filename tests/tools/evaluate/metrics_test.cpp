#include "tools/evaluate/metrics.h"

#include "tests/message_of.h"
#include "tests/tools/fixtures.h"

namespace beampipe::metrics_test {

TEST(ErrorStats, OfAConstantOffset) {
  const ErrorStats stats = measure_error(flat_image(7, 5, 0.25f), flat_image(7, 5, 0.75f));
  EXPECT_DOUBLE_EQ(stats.rmse, 0.5);
  EXPECT_DOUBLE_EQ(stats.bias, -0.5);
  EXPECT_DOUBLE_EQ(stats.p99, 0.5);
  EXPECT_DOUBLE_EQ(stats.max, 0.5);
}

TEST(ErrorStats, OppositeErrorsHaveNoBias) {
  Image image = flat_image(2, 1, 0.5f);
  image.rgba[0] = 0.75f;
  image.rgba[4] = 0.25f;
  const ErrorStats stats = measure_error(image, flat_image(2, 1, 0.5f));
  EXPECT_DOUBLE_EQ(stats.bias, 0.0);
  EXPECT_DOUBLE_EQ(stats.rmse, std::sqrt(2 * 0.25 * 0.25 / 6));
  EXPECT_DOUBLE_EQ(stats.max, 0.25);
}

// Errors 1/1024 .. n/1024 in mixed order, every second one negative.
Image staircase(std::uint32_t pixels) {
  Image image = flat_image(pixels, 1, 0.0f);
  const std::uint32_t n = 3 * pixels;
  for (std::uint32_t i = 0; i < n; ++i) {
    const float error = static_cast<float>((i * 7) % n + 1) / 1024.0f;
    image.rgba[4 * (i / 3) + i % 3] = i % 2 ? -error : error;
  }
  return image;
}

TEST(ErrorStats, P99IsTheValueAtRankCeilOf99Percent) {
  // The rank of p99 is ceil(0.99 n). 3 values are fewer than 100; 99 to 102 are around 100, and 300 and 303 around 300.
  const std::uint32_t cases[][2] = {{1, 3}, {33, 99}, {34, 101}, {100, 297}, {101, 300}, {200, 594}};
  for (const auto& [pixels, rank] : cases) {
    const ErrorStats stats = measure_error(staircase(pixels), flat_image(pixels, 1, 0.0f));
    EXPECT_DOUBLE_EQ(stats.p99 * 1024, rank) << pixels << " pixels";
    EXPECT_DOUBLE_EQ(stats.max * 1024, 3 * pixels) << pixels << " pixels";
  }
}

TEST(ErrorStats, PoolingFramesIsMeasuringThemAsOnePicture) {
  Image joined = staircase(500);
  const Image zero = flat_image(500, 1, 0.0f);
  ErrorAccumulator pooled(500);
  for (const auto& [first, width] : {std::pair<std::uint32_t, std::uint32_t>{0, 20}, {20, 430}, {450, 50}}) {
    const auto begin = joined.rgba.begin() + 4 * first;
    pooled.add(Image{width, 1, std::vector<float>(begin, begin + 4 * width)}, flat_image(width, 1, 0.0f));
  }
  const ErrorStats whole = measure_error(joined, zero), parts = pooled.stats();
  EXPECT_EQ(parts.p99, whole.p99);
  EXPECT_EQ(parts.max, whole.max);
  EXPECT_DOUBLE_EQ(parts.rmse, whole.rmse);
  EXPECT_NEAR(parts.bias, whole.bias, 1e-15);
}

TEST(ErrorStats, RefusesWhatCannotBeCompared) {
  EXPECT_THROW(measure_error(flat_image(2, 3, 0), flat_image(3, 2, 0)), std::invalid_argument);
  EXPECT_THROW(pixel_errors(flat_image(2, 3, 0), flat_image(3, 2, 0)), std::invalid_argument);
  Image image = flat_image(4, 3, 0.5f);
  image.rgba[4 * (4 * 2 + 1) + 2] = std::numeric_limits<float>::infinity();
  expect_parts(message_of<std::runtime_error>([&] { measure_error(image, flat_image(4, 3, 0.5f)); }), {"(1, 2)"});
}

TEST(ErrorStats, WantsExactlyThePixelsThatWereAnnounced) {
  ErrorAccumulator accumulator(6);
  accumulator.add(flat_image(2, 2, 0), flat_image(2, 2, 0));
  EXPECT_THROW(accumulator.stats(), std::logic_error);
  accumulator.add(flat_image(2, 1, 0), flat_image(2, 1, 0));
  EXPECT_EQ(accumulator.stats(), ErrorStats{});
}

TEST(PixelErrors, AreTheRootOfTheMeanSquareOfTheChannels) {
  Image image = flat_image(2, 1, 0.0f);
  image.rgba[4] = 0.5f;
  image.rgba[6] = -0.25f;
  const std::vector<float> errors = pixel_errors(image, flat_image(2, 1, 0.0f));
  ASSERT_EQ(errors.size(), 2u);
  EXPECT_EQ(errors[0], 0.0f);
  EXPECT_FLOAT_EQ(errors[1], static_cast<float>(std::sqrt((0.25 + 0.0625) / 3)));
}

const std::vector<LadderRung> kLadder = {{1, 0.4}, {4, 0.1}, {16, 0.025}};  // RMSE = 0.4 / N

TEST(EquivalentMsaa, IsStraightInLogLogBetweenRungs) {
  for (const double n : {1.1, 2.0, 3.9, 5.0, 15.9}) {
    const EquivalentMsaa emr = equivalent_msaa(0.4 / n, kLadder);
    EXPECT_NEAR(emr.samples, n, 1e-9);
    EXPECT_FALSE(emr.is_lower_bound || emr.is_upper_bound);
  }
}

TEST(EquivalentMsaa, IsARungOrBetweenTwoOrABound) {
  // The curve of `uneven` is 0.4 at 1, 0.1 at 4, still 0.1 at 8 and 16, and 0.05 at 32. If the error rises at the end,
  // a technique that is better than all rungs still gets the last rung.
  const std::vector<LadderRung> uneven = {{1, 0.4}, {4, 0.1}, {8, 0.2}, {16, 0.1}, {32, 0.05}},
                                rising = {{1, 0.4}, {4, 0.1}, {8, 0.2}},
                                exact_at_4 = {{1, 0.4}, {2, 0.2}, {4, 0.0}, {8, 0.0}},
                                always_exact = {{1, 0.0}, {2, 0.0}}, one = {{8, 0.1}};
  const struct {
    std::vector<LadderRung> ladder;
    double error;
    EquivalentMsaa expected;
  } cases[] = {
      {kLadder, 0.4, {1, false, false}},     {kLadder, 0.1, {4, false, false}},
      {kLadder, 0.025, {16, false, false}},  {kLadder, 0.41, {1, false, true}},
      {kLadder, 0.02, {16, true, false}},    {kLadder, 0.0, {16, true, false}},
      {uneven, 0.1, {4, false, false}},  // the smallest N with this error
      {rising, 0.05, {8, true, false}},      {exact_at_4, 0.0, {4, false, false}},
      {exact_at_4, 0.1, {2, false, false}},  {always_exact, 0.0, {1, false, false}},
      {always_exact, 0.1, {1, false, true}}, {one, 0.1, {8, false, false}},
      {one, 0.2, {8, false, true}},          {one, 0.05, {8, true, false}},
  };
  for (const auto& [ladder, error, expected] : cases)
    EXPECT_EQ(equivalent_msaa(error, ladder), expected) << error << " of " << ladder.size() << " rungs";
  EXPECT_NEAR(equivalent_msaa(0.2, uneven).samples, 2.0, 1e-9);
  EXPECT_NEAR(equivalent_msaa(0.1 / std::sqrt(2.0), uneven).samples, 16 * std::sqrt(2.0), 1e-9);
  EXPECT_EQ(best_error(rising), 0.1);
}

TEST(EquivalentMsaa, IsOpenByTheUnevennessOfTheLadder) {
  // 0.4 / N, but the last error is too large by a factor of e^d. Of the four rungs between others, that of 16 samples
  // lies d / 2 below the line between its neighbours, whose variance is 1 + 1/4 + 1/4 of that of a rung. So the
  // unevenness is sqrt((d / 2)^2 / 1.5 / 4) = d / sqrt(24).
  const double unevenness_of_ladder = 0.2, d = unevenness_of_ladder * std::sqrt(24.0);
  const std::vector<LadderRung> ladder = {{1, 0.4},  {2, 0.2},    {4, 0.1},
                                          {8, 0.05}, {16, 0.025}, {32, 0.0125 * std::exp(d)}};
  ASSERT_TRUE(unevenness(ladder));
  EXPECT_NEAR(*unevenness(ladder), unevenness_of_ladder, 1e-12);
  const EquivalentMsaa emr = limited_equivalent_msaa(0.1, ladder);
  EXPECT_EQ(emr.samples, 4);
  EXPECT_NEAR(emr.low.value(), 4 * std::exp(-0.2), 1e-9);
  EXPECT_NEAR(emr.high.value(), 4 * std::exp(0.2), 1e-9);
  EXPECT_FALSE(limited_equivalent_msaa(0.38, ladder).low) << "worse than the ladder";
  EXPECT_FALSE(limited_equivalent_msaa(0.026, ladder).high) << "better than the ladder";
}

TEST(EquivalentMsaa, IndependentRangesAddUpAsSquares) {
  const std::vector<LadderRung> ladder = {{1, 0.4}, {4, 0.1}, {16, 0.025}};
  const EmrRange narrow{4 / std::exp(0.3), 4 * std::exp(0.5)}, wide{4 / std::exp(0.4), 4 * std::exp(1.2)};
  const EquivalentMsaa emr = limited_equivalent_msaa(0.1, ladder, {narrow, wide});
  EXPECT_EQ(emr.samples, 4);
  EXPECT_NEAR(emr.low.value(), 4 / std::exp(0.5), 1e-9);
  EXPECT_NEAR(emr.high.value(), 4 * std::exp(1.3), 1e-9);
  EXPECT_FALSE(limited_equivalent_msaa(0.1, ladder, {narrow, {{}, 8}}).low) << "one is open";
}

TEST(EquivalentMsaa, IsOpenByTheErrorOfTheReference) {
  // Errors 0.4 / N and that of the reference, 0.03, add up as squares. Without it, the technique has the rate 4.
  const double of_reference = 0.03;
  const auto measured = [&](double error) { return std::hypot(error, of_reference); };
  const std::vector<LadderRung> ladder = {{1, measured(0.4)}, {4, measured(0.1)}, {16, measured(0.025)}};
  const EmrRange at_rung = range_by_reference(measured(0.1), ladder, of_reference);
  EXPECT_NEAR(at_rung.low.value(), 4, 1e-9);
  EXPECT_NEAR(at_rung.high.value(), 4, 1e-9);
  const double rate = equivalent_msaa(measured(0.05), ladder).samples, truth = 8;
  ASSERT_GT(rate, 8.1);
  const EmrRange between = range_by_reference(measured(0.05), ladder, of_reference);
  EXPECT_NEAR(between.low.value(), truth, 1e-9);
  EXPECT_NEAR(between.high.value(), rate * rate / truth, 1e-9);
  EXPECT_FALSE(range_by_reference(of_reference, ladder, of_reference).high) << "nothing is known to be left";
  EXPECT_FALSE(range_by_reference(measured(0.5), ladder, of_reference).low) << "worse than the ladder";
}

TEST(EquivalentMsaa, DoesNotConvergeWhereTheLadderFallsNoMore) {
  const std::vector<LadderRung> flat = {{1, 0.4}, {2, 0.2}, {4, 0.1}, {8, 0.11}, {16, 0.1}, {32, 0.105}};
  EXPECT_FALSE(converges(flat));
  EXPECT_TRUE(limited_equivalent_msaa(0.01, flat).does_not_converge);
  const EquivalentMsaa on_the_slope = limited_equivalent_msaa(0.2, flat);
  EXPECT_FALSE(on_the_slope.does_not_converge);
  EXPECT_EQ(on_the_slope.samples, 2);
  // A straight ladder converges however slowly it falls, and of a short or exact one nothing is known.
  EXPECT_TRUE(converges({{1, 0.4}, {2, 0.36}, {4, 0.324}, {8, 0.2916}, {16, 0.26244}}));
  EXPECT_TRUE(converges({{1, 0.4}, {2, 0.1}, {4, 0.1}, {8, 0.1}}));
  EXPECT_TRUE(converges({{1, 0.4}, {2, 0.1}, {4, 0.1}, {8, 0.1}, {16, 0}}));
  EXPECT_FALSE(limited_equivalent_msaa(0.01, {{1, 0.4}, {4, 0.1}}).low);
}

TEST(EquivalentMsaa, NeedsARisingLadder) {
  EXPECT_THROW(equivalent_msaa(0.1, {}), std::invalid_argument);
  EXPECT_THROW(equivalent_msaa(0.1, {{4, 0.1}, {4, 0.1}}), std::invalid_argument);
  EXPECT_THROW(equivalent_msaa(0.1, {{4, 0.1}, {2, 0.2}}), std::invalid_argument);
  EXPECT_THROW(equivalent_msaa(0.1, {{0, 0.1}}), std::invalid_argument);
}

TEST(Flicker, IsTheChangeOfTheErrorAlone) {
  const Image reference{1, 2, {0, 0, 0, 1, 0.5f, 0.5f, 0.5f, 1}}, brighter{1, 2, {1, 1, 1, 1, 1, 1, 1, 1}};
  const Image image{1, 2, {0.25f, 0, 0, 1, 0.5f, 0.5f, 0.5f, 0}};
  const Image next{1, 2, {1.25f, 1, 1, 1, 1, 1, 0.25f, 1}};
  const std::vector<float> before = signed_errors(image, reference), after = signed_errors(next, brighter);
  EXPECT_EQ(before, (std::vector<float>{0.25f, 0, 0, 0, 0, 0}));
  EXPECT_DOUBLE_EQ(flicker(before, after), std::sqrt(0.75 * 0.75 / 6));
  EXPECT_EQ(flicker(before, before), 0);
  EXPECT_THROW(flicker(before, {}), std::invalid_argument);
}

}  // namespace beampipe::metrics_test
