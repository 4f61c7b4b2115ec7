// Compares single pixels with the formula.
#include "stages/temporal/temporal.h"

#include "tests/test.h"

namespace beampipe::temporal_test {

constexpr float kOld = 1.0f, kOther = 0.5f, kNew = 0.25f;

// Two pixels in a row. The history is kOld at the first and kOther at the second. The new frame is kNew at both, and
// its boxes contain all colours.
struct Fixture {
  CurrentFrame frame{2, 1};
  History history{.frames = 1, .width = 2, .height = 1, .color = {glm::vec4(kOld), glm::vec4(kOther)}, .looks = {0, 0}};

  Fixture() {
    frame.color.assign(2, glm::vec4(kNew));
    frame.low.assign(2, glm::vec4(0));
    frame.high.assign(2, glm::vec4(2));
  }
  void close_box() { frame.low = frame.high = frame.color; }

  float first_pixel(const TemporalOptions& options) const {
    StageCounters counters;
    std::vector<glm::vec4> image(2);
    temporal(frame, options, history, {0, 0, 2, 1}, counters, image);
    return image[0].r;
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
  const TemporalOptions options{0.1f, 0.05f};
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
  EXPECT_EQ(fixture.first_pixel({0.2f, 0.05f}), kOld);
  fixture.history.looks[0] = 7;
  EXPECT_EQ(fixture.first_pixel({0.2f, 0.05f}), kNew) << "the old surface is gone";
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
  EXPECT_NEAR(fixture.first_pixel({0.1f, 0.05f}), blended(kOld, 0.1f), kFp16) << "nothing is clamped at rest";
  fixture.history.looks[1] = 7;
  EXPECT_NEAR(fixture.first_pixel({0.1f, 0.05f}), blended(kOld, 0.1f), kFp16) << "the nearest texel has the same look";
  fixture.history.looks[0] = 7;
  EXPECT_EQ(fixture.first_pixel({0.1f, 0.05f}), kNew);
}

TEST(Temporal, CountsWhatItLooksAt) {
  Fixture fixture;
  fixture.frame.motion[1] = glm::vec2(1000);  // off the screen, so there is nothing to reuse
  StageCounters counters;
  std::vector<glm::vec4> image(2);
  temporal(fixture.frame, {0.1f}, fixture.history, {0, 0, 2, 1}, counters, image);
  // Both pixels: two sums, four comparisons, the motion and four channels from fp16, and four to fp16. The first pixel:
  // its first texel, four weights, 24 values from fp16, the known part and, for each channel, 4 weights, the clamp and
  // two blends.
  const OperationCounts both{.add = 2 + 4, .convert = 2 + 8},
      first{4 + 1 + 4 * 6, 6 + 4 * (3 + 2 + 4), 0, 0, 0, 2 + 2 + 24 + 1};
  OperationCounts all = both * 2;
  all += first;
  EXPECT_EQ(counters.ops, all);
  EXPECT_EQ(counters.bytes_read, 2u * (8 + 17 + 4) + 4 * 8);
  EXPECT_EQ(counters.bytes_written, 2u * 8);
  EXPECT_EQ(counters.items_in, 2u);
  EXPECT_EQ(counters.items_out, 2u);
  EXPECT_EQ(counters.lanes_used, 1u) << "one has a history";
  EXPECT_EQ(counters.lanes_issued, 2u);
  counters = {};
  temporal(fixture.frame, {0.1f, 0.05f}, fixture.history, {0, 0, 2, 1}, counters, image);
  all += OperationCounts{
      .add = 3 + 1 + 2 + 2,
      .special = 1,
      .convert = 1};  // the texel with the largest weight, the part of the clamp, the look, the known part
  EXPECT_EQ(counters.ops, all);
  EXPECT_EQ(counters.bytes_read, 2u * (8 + 17 + 4 + 4 + 2) + 4 * 8 + 4);
  counters = {};
  neighborhood_box({0, 0, 2, 1}, counters, fixture.frame);
  EXPECT_EQ(counters.ops, (OperationCounts{.add = 2 * 8, .convert = 2 * (4 + 4 + 8)})) << "each has one neighbour";
  EXPECT_EQ(counters.bytes_read, 2u * 2 * 8);
  EXPECT_EQ(counters.bytes_written, 2u * 17);
}

}  // namespace beampipe::temporal_test
