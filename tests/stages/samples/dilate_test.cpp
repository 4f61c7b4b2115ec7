// Quads that are worked out by hand.
#include "stages/samples/dilate.h"

#include "tests/test.h"

namespace beampipe::dilate_test {

const std::vector<glm::vec3> kColors = {glm::vec3(1.0f), glm::vec3(0.5f), glm::vec3(0.25f)};
const std::vector<std::uint32_t> kDraws = {0, 1, 0};
const glm::vec3 kBackground(0.125f);

CurrentFrame dilated(QuadFrame quads, std::uint32_t width, std::uint32_t height) {
  for (SampleQuad& quad : quads.quads) {
    for (int p = 0; p < 4; ++p)
      if (quad.triangle[p] != kNoTriangle) quad.color[p] = kColors[quad.triangle[p]];
    for (ExtraSample& extra : quad.extras)
      if (extra.triangle != kNoTriangle) extra.color = kColors[extra.triangle];
  }
  CurrentFrame frame(width, height);
  StageCounters counters;
  const Tile all{0, 0, static_cast<std::int32_t>(width), static_cast<std::int32_t>(height)};
  dilate({quads, kDraws, kBackground}, all, counters, frame);
  return frame;
}

TEST(Dilate, APixelIsTheMeanWeightedByItsBits) {
  QuadFrame quads(2, 2);
  // Pixel 0 has five samples of shading sample 0 and three of sample 3. Pixel 1 has only samples of sample 1. Pixel 2
  // has two of sample 2, the background. Pixel 3 has none.
  quads.quads[0] = {{0, 1, kNoTriangle, 2}, {0x1fu, 0xff00u, 0x030000u, 0xe0u}, {0, 8, 16, 24}, {}};
  const CurrentFrame frame = dilated(quads, 2, 2);
  EXPECT_FLOAT_EQ(frame.color[0].r, (5 * 1.0f + 3 * 0.25f) / 8);
  EXPECT_FLOAT_EQ(frame.color[0].a, 1);
  EXPECT_FLOAT_EQ(frame.color[1].r, 0.5f);
  EXPECT_FLOAT_EQ(frame.color[2].r, 0.125f);
  EXPECT_FLOAT_EQ(frame.color[2].a, 0);
  EXPECT_FLOAT_EQ(frame.color[3].r, 0.25f);  // the colour of its own sample
  EXPECT_EQ(frame.known, (std::vector<float>{1, 1, 0.25f, 0}));
  EXPECT_EQ(unknown_part(frame), (std::vector<float>{0, 0, 0.75f, 1}));
}

TEST(Dilate, BoxesAreOfNeighborsOfTheSameDraw) {
  // Two quads next to each other: triangles 0 1 | 2 0 above, 1 1 | 1 1 below. Each sample has its own pixel.
  QuadFrame quads(4, 2);
  quads.quads[0] = {{0, 1, 1, 1}, {0xffu, 0xff00u, 0xff0000u, 0xff000000u}, {0, 8, 16, 24}, {}};
  quads.quads[1] = {{2, 0, 1, 1}, {0xffu, 0xff00u, 0xff0000u, 0xff000000u}, {0, 8, 16, 24}, {}};
  const CurrentFrame frame = dilated(quads, 4, 2);
  EXPECT_EQ(frame.low[0].r, 1.0f);  // no neighbour belongs to draw 0
  EXPECT_EQ(frame.high[0].r, 1.0f);
  EXPECT_EQ(frame.low[2].r, 0.25f);  // itself,
  EXPECT_EQ(frame.high[2].r, 1.0f);  // and the one on its right
  EXPECT_EQ(frame.low[5].r, 0.5f);
  EXPECT_EQ(frame.high[5].r, 0.5f);
}

// Pixel 0 has four samples of its own and four of an extra one, of triangle 2, which lies at pixel 3. Pixel 3 has two
// of that and six of an extra one of the background.
TEST(Dilate, ExtraSamplesCountAsTheOthersDo) {
  QuadFrame quads(2, 2);
  quads.quads[0] = {{0, 1, 1, 0}, {0x0fu, 0xff00u, 0xff0000u, 0}, {0, 8, 16, 24}, {}};
  quads.quads[0].extras = {{2, 0x030000f0u, 24, {}}, {kNoTriangle, 0xfc000000u, 26, {}}};
  const CurrentFrame frame = dilated(quads, 2, 2);
  EXPECT_FLOAT_EQ(frame.color[0].r, (4 * 1.0f + 4 * 0.25f) / 8);
  EXPECT_FLOAT_EQ(frame.color[3].r, (2 * 0.25f + 6 * 0.125f) / 8);
  EXPECT_FLOAT_EQ(frame.color[3].a, 2.0f / 8);
  EXPECT_EQ(frame.known, (std::vector<float>{1, 1, 1, 1}));
  // Triangles 0 and 2 are of one draw. The first sample's box has only those that pixels store: itself and that of
  // pixel 3, both 1. The extra one's box is from itself to these.
  EXPECT_FLOAT_EQ(frame.low[0].r, (4 * 1.0f + 4 * 0.25f) / 8);
  EXPECT_FLOAT_EQ(frame.high[0].r, 1);
}

TEST(Dilate, CountsWhatItLooksAt) {
  CurrentFrame frame(4, 4);
  StageCounters counters;
  dilate({QuadFrame(4, 4), kDraws, kBackground}, {0, 0, 4, 4}, counters, frame);
  const std::uint64_t neighbors = 4 * 3 + 8 * 5 + 4 * 8;  // corners, sides, inside
  EXPECT_EQ(counters.bytes_read, 16 * (6 + 4 + 4) + neighbors * (6 + 4));
  EXPECT_EQ(counters.bytes_written, 16u * (8 + 16 + 1));
  EXPECT_EQ(counters.items_in, 16u);
  EXPECT_EQ(counters.items_out, 16u);
  EXPECT_EQ(counters.lanes_used, 0u) << "nothing is known";
  EXPECT_EQ(counters.lanes_issued, 16u);
  // One extra sample at a corner: 6 + 4 + 4 bytes and 4 neighbours with the one stored there. A mask of 0 ends the
  // lists of all quads but this one, which has no more room.
  QuadFrame quads(4, 4);
  quads.quads[0].extras = {{kNoTriangle, 0, 0, {}}};
  const StageCounters without = counters;
  counters = {};
  dilate({quads, kDraws, kBackground, 1}, {0, 0, 4, 4}, counters, frame);
  EXPECT_EQ(counters.bytes_read - without.bytes_read, 14u + 4 * (6 + 4) + 3 * 4);
}

}  // namespace beampipe::dilate_test
