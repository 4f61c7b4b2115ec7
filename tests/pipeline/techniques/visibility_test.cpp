// One sample per pixel, shaded after visibility is known: visibility and deferred.

#include "tests/pipeline/test_pictures.h"

namespace beampipe::visibility_test {

// They differ from msaa:1 by the rounding of its colours to fp16 alone.
TEST(Visibility, ThePictureIsThatOfOneSample) {
  const Trace trace = random_trace(40, 30, 100, 2);
  EXPECT_LT(worst_difference(picture("visibility", trace), picture("msaa:1", trace)), 0x1p-11);
}

// One invocation for each pixel that shows the triangle, and none for those that it hides.
TEST(Visibility, ShadesEveryVisiblePixelOnceWithoutHelpers) {
  std::vector<PixelSpaceTriangle> triangles = quad(0, 0, 8, 8, 0.6, glm::vec3(1, 0, 0));
  append(triangles, quad(2, 2, 6, 6, 0.3, glm::vec3(0, 1, 0)));
  for (const char* spec : {"visibility", "dvm"}) {
    const FrameResult found = render(spec, pixel_trace(8, 8, triangles));
    EXPECT_EQ(stage_of(found, "shade").lanes_used, 64u) << spec;
    EXPECT_EQ(stage_of(found, "shade").lanes_issued, 64u) << spec;
    EXPECT_EQ(stage_of(found, "light").items_in, 64u) << spec;
  }
}

TEST(Deferred, ThePictureIsThatOfVisibility) {
  const Trace trace = random_trace(40, 30, 100, 2);
  EXPECT_EQ(picture("deferred", trace).rgba, picture("visibility", trace).rgba);
}

// Each pass sets up and rasterizes the triangle. The first one writes a depth of 4 bytes in each of 6 pixels, the other
// one, in forward shading, a colour of 6 bytes.
TEST(Deferred, ThePrepassIsCountedApart) {
  const FrameResult one = render("visibility", half_square());
  for (const char* spec : {"deferred", "msaa:1,prepass", "acaa:1", "taa:1,shading=deferred", "taa:1,shading=forward"}) {
    const FrameResult two = render(spec, half_square());
    for (const char* stage : {"vertex_setup", "sample_raster"})
      for (const char* pass : {"prepass_", ""}) {
        StageCounters found = stage_of(two, std::string(pass) + stage);
        found.stage = find_stage(stage).value();
        EXPECT_EQ(found, stage_of(one, stage)) << spec << ' ' << pass << stage;
      }
    EXPECT_EQ(two.stages.front().stage, Stage(StageId::vertex_setup, Pass::prepass)) << spec;
    EXPECT_EQ(stage_of(two, "prepass_depth_test").bytes_written, 6u * 4) << spec;
    const bool is_forward = std::string(spec).starts_with("msaa") || std::string(spec).ends_with("forward");
    EXPECT_EQ(stage_of(two, "depth_test").bytes_written, is_forward ? 6u * 6 : 0u) << spec;
    EXPECT_EQ(stage_of(two, "depth_test").items_in, 6u) << spec;
  }
}

// The samples are those of msaa:N, and flat colours are the same everywhere.
TEST(Visibility, ThePictureOfNSamplesIsThatOfMsaa) {
  const Trace trace = random_trace(40, 30, 100, 2);
  for (const std::string n : {"2", "4", "8", "16"})
    EXPECT_LT(worst_difference(picture("visibility:" + n, trace), picture("msaa:" + n, trace)), 0x1p-10) << n;
  EXPECT_EQ(picture("visibility:1", trace).rgba, picture("visibility", trace).rgba);
}

// 16 pixels have 8 samples each, all of which the triangles cover, whatever the number of triangles.
TEST(Visibility, ShadesEverySampleByItself) {
  std::vector<PixelSpaceTriangle> triangles = quad(2, 2, 6, 6, 0.5, glm::vec3(1));
  const FrameResult found = render("visibility:8", pixel_trace(8, 8, triangles));
  EXPECT_EQ(stage_of(found, "material_sort").items_in, 64u * 8);
  EXPECT_EQ(stage_of(found, "material_sort").items_out, 16u * 8);
  EXPECT_EQ(stage_of(found, "shade").lanes_used, 16u * 8);
  EXPECT_EQ(stage_of(found, "shade").lanes_issued, 16u * 8);
  EXPECT_EQ(stage_of(found, "light").items_in, 16u * 8);
  EXPECT_EQ(stage_of(found, "resolve").items_in, 64u * 8);
}

}  // namespace beampipe::visibility_test
