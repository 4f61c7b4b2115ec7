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

TEST(ClosedDepth, HidesEverywhereWhatLiesBehindTheFarthestPixel) {
  ClosedDepth closed(Tile{4, 6, 6, 7});
  closed.close(4, 6, -0.5f);
  closed.refresh();
  EXPECT_FALSE(closed.hides_everywhere(0.0f));
  closed.close(5, 6, -0.25f);
  closed.refresh();
  EXPECT_TRUE(closed.hides_everywhere(-0.1875f));
  EXPECT_FALSE(closed.hides_everywhere(-0.25f));
}

}  // namespace beampipe::closed_depth_test
