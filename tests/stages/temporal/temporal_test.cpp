// Compares single pixels with the formula.
#include "stages/temporal/temporal.h"

#include "tests/test.h"

namespace beampipe::temporal_test {

constexpr float kOld = 1.0f, kOther = 0.5f, kNew = 0.25f;

// Two pixels in a row. The history is kOld at the first and kOther at the second. The new frame is kNew at both, and
// its boxes contain all colours.
struct Fixture {
  CurrentFrame frame{2, 1};
  History history{.frames = 1,
                  .width = 2,
                  .height = 1,
                  .color = {glm::vec4(kOld), glm::vec4(kOther)},
                  .deviation = {glm::vec4(0), glm::vec4(0)},
                  .looks = {0, 0}};

  Fixture() {
    frame.color.assign(2, glm::vec4(kNew));
    frame.low.assign(2, glm::vec4(0));
    frame.high.assign(2, glm::vec4(2));
  }
  void close_box() { frame.low = frame.high = frame.color; }

  Accumulated after(const TemporalOptions& options, StageCounters& counters) const {
    Accumulated found(2, options.clamp);
    temporal(frame, options, history, {0, 0, 2, 1}, counters, found);
    return found;
  }
  float first_pixel(const TemporalOptions& options) const {
    StageCounters ignored;
    return after(options, ignored).color[0].r;
  }
  // Of the channels' past values.
  glm::vec4 deviation(const TemporalOptions& options) const {
    StageCounters ignored;
    return after(options, ignored).deviation[0];
  }
};

float blended(float old, float weight) { return old + (kNew - old) * weight; }

constexpr float kFp16 = 0x1p-11f;  // relative error

TEST(Temporal, BlendsTheNewFrameIntoTheHistory) {
  const Fixture fixture;
  for (const float weight : {0.1f, 0.5f, 1.0f})
    EXPECT_NEAR(fixture.first_pixel({weight}), blended(kOld, weight), kFp16);
}

TEST(Temporal, WithoutHistoryItIsTheFramesOwnColor) {
  Fixture fixture;
  fixture.history.width = 3;
  EXPECT_EQ(fixture.first_pixel({0.1f}), kNew);
  fixture = {};
  fixture.history.frames = 0;
  EXPECT_EQ(fixture.first_pixel({0.1f}), kNew);
  for (const float off : {-1.0f, 2.0f, std::numeric_limits<float>::infinity()}) {
    fixture = {};
    fixture.frame.motion[0] = {off, 0};
    EXPECT_EQ(fixture.first_pixel({0.1f}), kNew);
  }
}

TEST(Temporal, TakesTheHistoryFromWhereTheSurfaceWas) {
  Fixture fixture;
  fixture.frame.motion[0] = {1, 0};
  EXPECT_NEAR(fixture.first_pixel({0.1f}), blended(kOther, 0.1f), kFp16);
  fixture.frame.motion[0] = {0.25f, 0};  // between the two texels
  EXPECT_NEAR(fixture.first_pixel({0.1f}), blended(0.75f * kOld + 0.25f * kOther, 0.1f), kFp16);
}

TEST(Temporal, ClampsTheHistoryToTheBox) {
  Fixture fixture;
  fixture.frame.high[0] = glm::vec4(0.75f);
  EXPECT_NEAR(fixture.first_pixel({0.1f}), blended(0.75f, 0.1f), kFp16);
}

TEST(Temporal, TheClampFadesOutWhereNothingMoves) {
  Fixture fixture;
  fixture.close_box();
  const TemporalOptions options{0.1f, Clamp::rest, 0.05f};
  EXPECT_NEAR(fixture.first_pixel(options), blended(kOld, 0.1f), kFp16);
  fixture.frame.speeds[0] = 0.025f;
  EXPECT_NEAR(fixture.first_pixel(options), blended((kOld + kNew) / 2, 0.1f), 2 * kFp16);
  fixture.frame.speeds[0] = 3;
  EXPECT_EQ(fixture.first_pixel(options), kNew);
}

TEST(Temporal, WhatIsKnownInPartWeighsLess) {
  Fixture fixture;
  fixture.frame.known[0] = 0.5f;
  EXPECT_NEAR(fixture.first_pixel({0.2f}), blended(kOld, 0.1f), kFp16);
  fixture.frame.known[0] = 0;
  fixture.close_box();  // has no effect on an unknown pixel
  EXPECT_EQ(fixture.first_pixel({0.2f, Clamp::rest, 0.05f}), kOld);
  fixture.history.looks[0] = 7;
  EXPECT_EQ(fixture.first_pixel({0.2f, Clamp::rest, 0.05f}), kNew) << "the old surface is gone";
}

TEST(Temporal, ANeighborhoodsBoxEndsAtTheFrame) {
  CurrentFrame frame(3, 3);
  for (std::size_t i = 0; i < 9; ++i) frame.color[i] = glm::vec4(static_cast<float>(i));
  StageCounters counters;
  for (const Tile& tile : {Tile{0, 0, 2, 3}, Tile{2, 0, 3, 3}}) neighborhood_box(tile, counters, frame);
  EXPECT_EQ(frame.low[4].r, 0);
  EXPECT_EQ(frame.high[4].r, 8);
  EXPECT_EQ(frame.low[2].r, 1);
  EXPECT_EQ(frame.high[2].r, 5);
  EXPECT_EQ(frame.low[6].r, 3);
  EXPECT_EQ(frame.high[6].r, 7);
}

TEST(Temporal, WhereThePixelLookedOtherwiseTheClampIsWhole) {
  Fixture fixture;
  fixture.close_box();
  EXPECT_NEAR(fixture.first_pixel({0.1f, Clamp::rest, 0.05f}), blended(kOld, 0.1f), kFp16)
      << "nothing is clamped at rest";
  fixture.history.looks[1] = 7;
  EXPECT_NEAR(fixture.first_pixel({0.1f, Clamp::rest, 0.05f}), blended(kOld, 0.1f), kFp16)
      << "the nearest texel has the same look";
  fixture.history.looks[0] = 7;
  EXPECT_EQ(fixture.first_pixel({0.1f, Clamp::rest, 0.05f}), kNew);
}

// The camera rests, so nothing is clamped, whatever moved or changed its look. Only a frame under a moving camera is.
TEST(Temporal, TheCamerasRestAloneFadesTheClamp) {
  Fixture fixture;
  fixture.close_box();
  fixture.history.looks[0] = 7;
  const TemporalOptions options{0.1f, Clamp::camera, 0.05f};
  EXPECT_NEAR(fixture.first_pixel(options), blended(kOld, 0.1f), kFp16) << "a ghost";
  fixture.frame.speeds[0] = 0.0125f;
  EXPECT_NEAR(fixture.first_pixel(options), blended(0.75f * kOld + 0.25f * kNew, 0.1f), 2 * kFp16);
  fixture.frame.speeds[0] = 0.05f;
  EXPECT_EQ(fixture.first_pixel(options), kNew);
  fixture.frame.known[0] = 0;
  EXPECT_EQ(fixture.first_pixel(options), kOld) << "an unknown pixel has no box";
}

// The box is a point, kNew, 0.75 below the history.
TEST(Temporal, PastDeviationWidensTheBox) {
  Fixture fixture;
  fixture.close_box();
  fixture.history.deviation.assign(2, glm::vec4(0));
  const TemporalOptions options{0.1f, Clamp::variance, 0.05f, 2.0f};
  EXPECT_EQ(fixture.first_pixel(options), kNew) << "variance 0: the clamp is whole";
  fixture.history.deviation[0] = glm::vec4(0.125f);
  EXPECT_NEAR(fixture.first_pixel(options), blended(kNew + 2 * 0.125f, 0.1f), kFp16);
  fixture.history.deviation[0] = glm::vec4(0.5f);
  EXPECT_NEAR(fixture.first_pixel(options), blended(kOld, 0.1f), kFp16) << "within the box";
  fixture.frame.motion[0] = {0.75f, 0};
  EXPECT_EQ(fixture.first_pixel(options), kNew) << "the texel nearest to where the surface was has none";
}

// A value that weighs 1/2 and is `step` from the mean of others with variance v: the mean moves by step/2, so that both
// halves are step/2 from it, beside what the others varied: v/2 + step^2/4. What is not known changes nothing.
TEST(Temporal, DeviationIsThatOfTheWeightedValues) {
  Fixture fixture;
  fixture.history.deviation.assign(2, glm::vec4(0.5f, 0, 0, 0));
  const TemporalOptions options{0.5f, Clamp::variance};
  constexpr float kStep = kOld - kNew;
  EXPECT_NEAR(fixture.deviation(options).r, std::sqrt(0.5f * 0.5f / 2 + kStep * kStep / 4), kFp16);
  EXPECT_NEAR(fixture.deviation(options).g, kStep / 2, kFp16);
  fixture.frame.known[0] = 0;
  EXPECT_EQ(fixture.deviation(options), glm::vec4(0.5f, 0, 0, 0));
  fixture.history.frames = 0;
  EXPECT_EQ(fixture.deviation(options), glm::vec4(0));
}

// TemporalTwins count operations.
TEST(Temporal, CountsWhatItReadsAndWrites) {
  Fixture fixture;
  fixture.frame.motion[1] = glm::vec2(1000);  // off the screen, so there is nothing to reuse
  const auto count = [&](const TemporalOptions& options) {
    StageCounters counters;
    fixture.after(options, counters);
    return counters;
  };
  StageCounters counters = count({0.1f});
  EXPECT_EQ(counters.bytes_read, 2u * (8 + 17 + 4) + 4 * 8);
  EXPECT_EQ(counters.bytes_written, 2u * 8);
  EXPECT_EQ(counters.items_in, 2u);
  EXPECT_EQ(counters.items_out, 2u);
  EXPECT_EQ(counters.lanes_used, 1u) << "one has a history";
  EXPECT_EQ(counters.lanes_issued, 2u);
  const auto expect_more = [&](Clamp clamp, std::uint64_t read, std::uint64_t written) {
    const StageCounters found = count({0.1f, clamp});
    EXPECT_EQ(found.bytes_read - counters.bytes_read, read);
    EXPECT_EQ(found.bytes_written - counters.bytes_written, written);
  };
  expect_more(Clamp::camera, 2 * 2, 0);          // speeds
  expect_more(Clamp::rest, 2 * (4 + 2) + 4, 0);  // and looks, of which one is the history's
  expect_more(Clamp::variance, 8, 2 * 8);        // deviations
  counters = {};
  neighborhood_box({0, 0, 2, 1}, counters, fixture.frame);
  EXPECT_EQ(counters.bytes_read, 2u * 2 * 8);
  EXPECT_EQ(counters.bytes_written, 2u * 17);
}

}  // namespace beampipe::temporal_test
