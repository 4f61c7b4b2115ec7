// One sample per pixel, shaded after visibility is known: visibility and deferred.
#include <gtest/gtest.h>

#include "tests/pipeline/test_pictures.h"
#include "tests/pipeline/test_traces.h"

namespace beampipe {
namespace {

// They differ from msaa:1 by the rounding of its colours to fp16 alone.
TEST(Visibility, ThePictureIsThatOfOneSample) {
  const Trace trace = random_trace(40, 30, 100, 2);
  EXPECT_LT(worst_difference(picture("visibility", trace), picture("msaa:1", trace)), 0x1p-11);
}

// One invocation for each pixel that shows the triangle, and none for those that it hides.
TEST(Visibility, ShadesEveryVisiblePixelOnceWithoutHelpers) {
  std::vector<PixelSpaceTriangle> triangles = quad(0, 0, 8, 8, 0.6, glm::vec3(1, 0, 0));
  append(triangles, quad(2, 2, 6, 6, 0.3, glm::vec3(0, 1, 0)));
  const FrameResult found = render("visibility", pixel_trace(8, 8, triangles));
  EXPECT_EQ(stage_of(found, "shade").lanes_used, 64u);
  EXPECT_EQ(stage_of(found, "shade").lanes_issued, 64u);
  EXPECT_EQ(stage_of(found, "light").items_in, 64u);
}

TEST(Deferred, ThePictureIsThatOfVisibility) {
  const Trace trace = random_trace(40, 30, 100, 2);
  EXPECT_EQ(picture("deferred", trace).rgba, picture("visibility", trace).rgba);
}

// The second pass draws the same fragments and shades those that have the stored depth.
TEST(Deferred, TheGeometryIsDrawnTwiceAndShadedOnce) {
  const FrameResult one = render("visibility", half_square()), two = render("deferred", half_square());
  EXPECT_EQ(stage_of(two, "sample_raster").items_in, 2 * stage_of(one, "sample_raster").items_in);
  EXPECT_EQ(stage_of(two, "sample_raster").items_out, 2 * stage_of(one, "sample_raster").items_out);
  EXPECT_EQ(stage_of(two, "shade").lanes_used, stage_of(one, "shade").lanes_used);
}

}  // namespace
}  // namespace beampipe
