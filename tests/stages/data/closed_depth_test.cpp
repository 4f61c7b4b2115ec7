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

// Rows of quads in a tile of 5 x 3: in its last row, a quad has no lower cells.
TEST(ClosedDepth, TestsAndClosesRowsOfQuads) {
  ClosedDepth closed(Tile{4, 6, 9, 9});
  closed.close(7, 7, -0.75f);  // the last cell of the second quad
  closed.take_work();
  ClosingRow rows[] = {{4, 6, 0b11111111, 0b11000011}, {4, 8, 0b0001'0011'0011, 0b0000'0011'0011}};
  EXPECT_EQ(closed.hides_or_closes({-0.5f, -0.25f, true}, rows, 2), 7u + 5u);
  EXPECT_EQ(rows[0].visible, 0b01111111u);
  EXPECT_EQ(rows[1].visible, 0b0001'0011'0011u);
  const ClosedDepthWork work = closed.take_work();
  EXPECT_EQ(work.pixel_tests, 8u + 5u);
  EXPECT_EQ(work.hidden, 1u);
  EXPECT_EQ(work.closings, 3u + 4u);
  EXPECT_EQ(work.changes, 3u + 4u);
  EXPECT_TRUE(closed.hides(4, 6, -0.125f) && closed.hides(5, 6, -0.125f) && closed.hides(6, 7, -0.125f));
  EXPECT_FALSE(closed.hides(4, 7, -0.125f) || closed.hides(6, 6, -0.125f)) << "it covers a part of the cell";
  EXPECT_FALSE(closed.hides(7, 7, -0.75f)) << "hidden there, it does not close";
  for (const std::int32_t x : {4, 5, 6, 7}) EXPECT_TRUE(closed.hides(x, 8, -0.125f)) << x;
  EXPECT_FALSE(closed.hides(8, 8, 0.0f));

  ClosingRow again[] = {{4, 6, 0b1111, 0b1111}};
  EXPECT_EQ(closed.hides_or_closes({-0.125f, -0.125f, false}, again, 1), 2u);
  EXPECT_EQ(again[0].visible, 0b1100u);
  EXPECT_FALSE(closed.hides(4, 7, 0.0f)) << "it closes nothing";
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
  ClosingRow left[] = {{4, 6, 0b01, 0b01}}, right[] = {{4, 6, 0b10, 0b10}};
  closed.hides_or_closes({-0.75f, -0.75f, true}, left, 1);  // the nearer of the two
  closed.refresh();
  EXPECT_FALSE(closed.hides_everywhere(-0.25f));
  closed.hides_or_closes({-0.75f, -0.5f, true}, right, 1);
  closed.refresh();
  EXPECT_TRUE(closed.hides_everywhere(-0.375f));
}

}  // namespace beampipe::closed_depth_test
