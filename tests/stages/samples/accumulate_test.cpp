#include "stages/samples/accumulate.h"

#include "tests/test.h"

namespace beampipe::accumulate_test {

constexpr Tile kPixel{0, 0, 1, 1};

// One of four samples is clear, and a surface covers two of the others. The missing quarter shows the background too,
// but alpha is what surfaces cover.
TEST(Accumulate, TheBackgroundIsInTheColorAndNotInAlpha) {
  Accumulator accumulator(kPixel, 4, AccumulatorFormat::fp32, DoubleCounting::none);
  SampleTile depth(kPixel, {{}, standard_pattern(4)});
  depth.depth = {-0.5f, -0.5f, -0.25f, kFarDepth};
  StageCounters ignored;
  accumulate_background(depth, {0.5f, 0.25f, 1}, ignored, accumulator);
  accumulator.color[0] += glm::vec4(0.5f, 0, 0, 0.5f);
  EXPECT_EQ(resolve(accumulator, {0.5f, 0.25f, 1}, ignored),
            (std::vector<glm::vec4>{{0.5f + 0.5f * 0.5f, 0.5f * 0.25f, 0.5f, 0.5f}}));
}

// The second fragment finds one of its two samples taken, the third one both.
TEST(Accumulate, TheStencilIsWrittenWhereSamplesPass) {
  Accumulator accumulator(kPixel, 4, AccumulatorFormat::fp32, DoubleCounting::stencil);
  std::vector<SampleFragment> fragments = {{0, 0, 0, 0, 0b0011}, {1, 0, 0, 0, 0b0110}, {2, 0, 0, 0, 0b0101}};
  StageCounters counters;
  stencil_test(kPixel, counters, accumulator, fragments);
  ASSERT_EQ(fragments.size(), 2u);
  EXPECT_EQ(fragments[0].mask, 0b0011u);
  EXPECT_EQ(fragments[1].mask, 0b0100u);
  EXPECT_EQ(counters.items_in, 6u);
  EXPECT_EQ(counters.items_out, 3u);
  EXPECT_EQ(counters.bytes_read, 6u);
  EXPECT_EQ(counters.bytes_written, 3u);
}

}  // namespace beampipe::accumulate_test
