#include "tools/evaluate/mean_time.h"

#include "tests/test.h"

namespace beampipe::mean_time_test {

// Frames whose time is that of DRAM: so many clocks at the full rate.
TechniqueReport dram_report(const std::string& technique, const std::vector<std::uint64_t>& bytes) {
  TechniqueReport report;
  report.technique = technique;
  for (const std::uint64_t of_frame : bytes) {
    FrameReport frame;
    StageCounters stage{StageId::vertex_setup};
    stage.dram_bytes = of_frame;
    frame.stages = {stage};
    report.frames.push_back(frame);
  }
  return report;
}

// 448,700 bytes take 1000 clocks at the peak rate, and 1000 / 0.77 at what is reached of it.
TEST(MeanTime, IsThatOfTheFrames) {
  const Hardware titan = titan_v();
  const ModelledTime mean = mean_time(titan, 0, dram_report("beam", {448'700, 3 * 448'700}));
  for (const TimeKind& kind : kTimes) EXPECT_NEAR(mean.*kind.ms * titan.clock_mhz * 1e3, 2000 / 0.77, 1e-6) << kind.key;
  EXPECT_EQ(mean.busiest, "dram");
  ASSERT_EQ(mean.stages.size(), 1u);
  EXPECT_EQ(mean.stages[0].busiest, "dram");
}

// The efficiency lies between 0.57 and 0.94, and up to a root of kRequestSpread beyond that.
TEST(MeanTime, IntervalsFollowTheRanges) {
  const Hardware titan = titan_v();
  const std::vector<Hardware> draws = drawn_hardware(titan);
  const DrawnTime time = drawn_time(titan, draws, 0, dram_report("beam", {448'700}));
  const Interval clocks = time.interval(&ModelledTime::in_turn_ms);
  const double root = std::sqrt(kRequestSpread), per_clock = 1 / (titan.clock_mhz * 1e3);
  EXPECT_TRUE(clocks.contains(time.described.in_turn_ms));
  EXPECT_GT(clocks.low, 1000 / std::min(0.94 * root, 1.0) * per_clock * 0.999);
  EXPECT_LT(clocks.high, 1000 / (0.57 / root) * per_clock);
  EXPECT_GT(clocks.high / clocks.low, 1.3) << "nine tenths of a range of 1.65";
}

// The ranges of rates do not widen a quotient of two techniques that both wait for DRAM, but what their requests reach
// does. A technique over itself is 1.
TEST(MeanTime, QuotientsVaryByRequestsAlone) {
  const Hardware titan = titan_v();
  const std::vector<Hardware> draws = drawn_hardware(titan);
  const DrawnTime beam = drawn_time(titan, draws, 0, dram_report("beam", {448'700}));
  const DrawnTime twice = drawn_time(titan, draws, 0, dram_report("msaa:8", {2 * 448'700}));
  const Interval same = beam.interval_over(beam, &ModelledTime::in_turn_ms);
  EXPECT_EQ(same.low, 1);
  EXPECT_EQ(same.high, 1);
  const Interval quotient = twice.interval_over(beam, &ModelledTime::in_turn_ms);
  EXPECT_TRUE(quotient.contains(2));
  EXPECT_GT(quotient.low, 2 / kRequestSpread);
  EXPECT_LT(quotient.high, 2 * kRequestSpread);
  EXPECT_GT(quotient.high / quotient.low, 1.1);
}

}  // namespace beampipe::mean_time_test
