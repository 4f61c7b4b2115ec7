// The published rules, and alpha alone.

#include "tests/pipeline/test_pictures.h"

namespace beampipe::casav_test {

TEST(Casav, CountsAnAggregateForEachFragment) {
  // Rows 1 to 4 have 1, 2, 3 and 4 pixels with a part of the triangle. Pairs without area are dropped after
  // conservative_raster.
  const std::uint64_t with_area = 1 + 2 + 3 + 4;
  // The published rules shade in quads. Pixels 1..4 lie in the quads 0, 1 and 2 of each axis. The lower left half of
  // these 3 x 3 quads has 6 quads of 4 lanes.
  EXPECT_EQ(stage_of(parse_technique("casav").render(half_square(), 0, {1}), "shade").lanes_issued, 4u * 6);
  const StageCounters merging = stage_of(parse_technique("casav").render(half_square(), 0, {1}), "compose");
  EXPECT_EQ(merging.items_in, with_area);
  EXPECT_EQ(merging.items_out, 64u) << "pixels";
  EXPECT_EQ(merging.bytes_read, with_area * 42);
  EXPECT_EQ(merging.bytes_written, 64u * 42);
  EXPECT_EQ(merging.lanes_used, with_area);
  EXPECT_EQ(merging.lanes_issued, with_area);
  // A fragment of the published rules is an aggregate. One of `alpha` has no mask and no depth slab, only a coverage, a
  // colour and a depth.
  EXPECT_EQ(parse_technique("casav").render(half_square(), 0, {1}).a_buffer_peak_bytes, with_area * 46 + 256);
  EXPECT_EQ(parse_technique("alpha").render(half_square(), 0, {1}).a_buffer_peak_bytes, with_area * 18 + 256);
}

TEST(Casav, MasksCloseTheEdgeThatAlphaAloneLeaksThrough) {
  // Two triangles of area 1/2 tile the pixel. OVER treats them as independent and finds 1 - (1/2)^2. Masks show that
  // they do not overlap.
  const Trace trace = pixel_trace(2, 2, quad(0, 0, 1, 1, 0.5, glm::vec3(1, 0, 0)), glm::vec3(0, 0, 1));
  EXPECT_NEAR(pixel(picture("alpha", trace), 0, 0).r, 0.75f, 1e-3);
  EXPECT_NEAR(pixel(picture("casav:mask=exact", trace), 0, 0).r, 1.0f, 1e-3);
}

}  // namespace beampipe::casav_test
