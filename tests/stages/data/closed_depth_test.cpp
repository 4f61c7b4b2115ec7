#include "stages/data/closed_depth.h"

#include "tests/test.h"

namespace beampipe::closed_depth_test {

TEST(ClosedDepth, HidesWhatLiesBehindAndNotWhatLiesThere) {
  ClosedDepth closed(Tile{4, 6, 6, 7});
  EXPECT_FALSE(closed.hides(4, 6, 0.0f));
  closed.close(4, 6, -0.5f);
  closed.close(4, 6, -0.25f);  // farther than the depth that is known
  EXPECT_TRUE(closed.hides(4, 6, -0.4375f));
  EXPECT_FALSE(closed.hides(4, 6, -0.5f));
  EXPECT_FALSE(closed.hides(5, 6, 0.0f)) << "its neighbour";

  const std::int32_t x[] = {4, 4, 5}, y[] = {6, 6, 6};
  const float nearest[] = {-0.4375f, -0.5f, 0.0f};
  bool hidden[3] = {};
  closed.hides(x, y, nearest, 3, hidden);
  EXPECT_TRUE(hidden[0] && !hidden[1] && !hidden[2]) << "several at once";

  EXPECT_TRUE(closed.hides_or_closes(4, 6, -0.4375f, -0.4375f, true));
  EXPECT_FALSE(closed.hides_or_closes(4, 6, -0.5f, -0.5f, true));
  EXPECT_FALSE(closed.hides_or_closes(4, 6, -0.75f, -0.625f, false)) << "it covers a part of the pixel";
  EXPECT_FALSE(closed.hides(4, 6, -0.5f));
  EXPECT_FALSE(closed.hides_or_closes(4, 6, -0.75f, -0.625f, true));
  EXPECT_TRUE(closed.hides(4, 6, -0.5f));
}

// A row of quads in a tile of 5 x 3: in its last row, a quad has no lower cells.
TEST(ClosedDepth, TestsAndClosesRowsOfQuads) {
  ClosedDepth closed(Tile{4, 6, 9, 9});
  closed.close(7, 7, -0.75f);  // the last cell of the second quad
  closed.take_work();
  EXPECT_EQ(closed.hides_or_closes(4, 6, {0b11111111, 0b11000011}, -0.5f, -0.25f, true), 0b10000000u);
  EXPECT_TRUE(closed.hides(4, 6, -0.125f) && closed.hides(5, 6, -0.125f) && closed.hides(6, 7, -0.125f));
  EXPECT_FALSE(closed.hides(4, 7, -0.125f) || closed.hides(6, 6, -0.125f)) << "it covers a part of the cell";
  EXPECT_FALSE(closed.hides(7, 7, -0.75f)) << "hidden there, it does not close";
  const ClosedDepthWork work = closed.take_work();
  EXPECT_EQ(work.pixel_tests, 8u + 6u);
  EXPECT_EQ(work.hidden, 1u + 3u);
  EXPECT_EQ(work.closings, 3u);
  EXPECT_EQ(work.changes, 3u);

  EXPECT_EQ(closed.hides_or_closes(4, 6, {0b1111, 0b1111}, -0.125f, -0.125f, false), 0b0011u) << "closes nothing";
  EXPECT_FALSE(closed.hides(4, 7, 0.0f));
  EXPECT_EQ(closed.hides_or_closes(4, 8, {0b0001'0011'0011, 0b0001'0011'0011}, -0.5f, -0.5f, true), 0u);
  for (const std::int32_t x : {4, 5, 6, 7, 8}) EXPECT_TRUE(closed.hides(x, 8, -0.25f)) << x;
  EXPECT_FALSE(closed.hides(4, 7, 0.0f)) << "the row above";
}

TEST(ClosedDepth, HidesEverywhereWhatLiesBehindTheFarthestPixel) {
  ClosedDepth closed(Tile{4, 6, 6, 7});
  closed.close(4, 6, -0.5f);
  closed.refresh();
  EXPECT_FALSE(closed.hides_everywhere(0.0f));
  closed.close(5, 6, -0.25f);
  closed.refresh();
  EXPECT_TRUE(closed.hides_everywhere(-0.1875f));
  EXPECT_FALSE(closed.hides_everywhere(-0.25f));
  closed.hides_or_closes(4, 6, {0b01, 0b01}, -0.75f, -0.75f, true);  // the nearer of the two
  closed.refresh();
  EXPECT_FALSE(closed.hides_everywhere(-0.25f));
  closed.hides_or_closes(4, 6, {0b10, 0b10}, -0.75f, -0.5f, true);
  closed.refresh();
  EXPECT_TRUE(closed.hides_everywhere(-0.375f));
}

}  // namespace beampipe::closed_depth_test
