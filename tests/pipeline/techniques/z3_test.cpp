// Z3: the state of a pixel is read and written for each fragment, and merging loses little where it has to happen.

#include "tests/pipeline/test_pictures.h"

namespace beampipe::z3_test {

TEST(Z3, ReadsAndWritesAPixelForEachFragment) {
  const StageCounters merging = stage_of(parse_technique("z3").render(half_square(), 0, {1}), "compose");
  const std::uint64_t fragments = 1 + 2 + 3 + 4;
  EXPECT_EQ(merging.items_in, fragments);
  EXPECT_EQ(merging.items_out, fragments);
  EXPECT_EQ(merging.bytes_read, fragments * (26 + 50)) << "pixel, mask, plane, colour; three layers and their owners";
  EXPECT_EQ(merging.bytes_written, fragments * 50);
  EXPECT_EQ(merging.lanes_used, fragments);
  EXPECT_EQ(merging.lanes_issued, fragments);
}

// Two triangles fit into three layers, so nothing is merged and each position keeps its own surface.
TEST(Z3, WithoutMergesThePictureIsThatOfTheMaskPositions) {
  const Trace trace = pixel_trace(6, 6,
                                  {{{{-1, -1, 0.6}, {13, -1, 0.6}, {-1, 13, 0.6}}, glm::vec3(1, 0, 0)},
                                   {{{1.2, 0.8, 0.3}, {4.9, 0.9, 0.3}, {1.1, 4.7, 0.3}}, glm::vec3(0, 1, 0)}});
  const FrameResult found = render("z3", trace);
  EXPECT_EQ(sum_of(found, "merges"), 0);
  EXPECT_EQ(pixel(found.image, 2, 1), glm::vec3(0, 1, 0)) << "a pixel that the nearer triangle covers";
  EXPECT_EQ(pixel(found.image, 5, 5), glm::vec3(1, 0, 0)) << "a pixel that the farther triangle covers alone";
  // A pixel's red and green are shares of 32 positions.
  for (std::uint32_t y = 0; y < 6; ++y)
    for (std::uint32_t x = 0; x < 6; ++x) {
      const float green = 32 * pixel(found.image, x, y).g;
      EXPECT_NEAR(green, std::round(green), 0.02) << x << ' ' << y;
      EXPECT_NEAR(pixel(found.image, x, y).r + pixel(found.image, x, y).g, 1, 1e-3) << x << ' ' << y;
    }
}

}  // namespace beampipe::z3_test
