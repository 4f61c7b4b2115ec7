// Multisampling: samples that can be counted by hand, where fragments are shaded, and pictures.

#include "stages/data/half_bits.h"
#include "tests/pipeline/test_pictures.h"

namespace beampipe::msaa_test {

// A fragment of msaa:8 moves to its centroid if the triangle does not cover the centre of the pixel. msaa:1 has a
// fragment wherever the centre is covered, and here msaa:8 has one in each of these pixels too. The pictures are the
// same because colours are flat.
TEST(Msaa, TheCentroidIsForFragmentsThatOneSampleMisses) {
  const StageCounters one = stage_of(parse_technique("msaa:1").render(half_square(), 0, {1}), "shade");
  const FrameResult centre = parse_technique("msaa:8,at=centre").render(half_square(), 0, {1});
  EXPECT_EQ(centre.pixel_counters.count("centroids"), 0u);
  for (const char* spec : {"msaa:8,at=centroid", "msaa:8,at=centroid,prepass"}) {
    const FrameResult centroid = parse_technique(spec).render(half_square(), 0, {1});
    EXPECT_EQ(centroid.image.rgba, centre.image.rgba) << spec;
    const double moved = sum_of(centroid, "centroids");
    EXPECT_EQ(moved, static_cast<double>(stage_of(centre, "shade").items_in - one.items_in)) << spec;
    EXPECT_GT(moved, 0) << spec;
    EXPECT_GT(stage_of(centroid, "shade").ops.mul_add, stage_of(centre, "shade").ops.mul_add) << spec;
  }
}

TEST(Msaa, ADepthPassDoesNotChangeThePicture) {
  const Trace trace = random_trace(60, 40, 300, 6);
  for (const char* n : {"1", "8", "64"})
    EXPECT_EQ(render(std::string("msaa:").append(n), trace).image.rgba,
              render(std::string("msaa:").append(n).append(",prepass"), trace).image.rgba);
}

// One pixel is covered. Its colour is stored with the depth, and handed on with as many bytes.
TEST(Msaa, ColoursAreStoredInTheirFormat) {
  const Trace trace = pixel_trace(1, 1, quad(-1, -1, 2, 2, 0.5, glm::vec3(0.1f, 0.3f, 0.7f)));
  const auto red = [&](const std::string& format) { return render("msaa:1,color=" + format, trace).image.rgba.at(0); };
  const float exact = red("rgba32f");
  EXPECT_EQ(red("rgba8"), std::round(exact * 255) / 255.0f);
  EXPECT_EQ(red("rgba16f"), nearest_half(exact));
  EXPECT_NE(red("rgba16f"), exact);
  for (const auto& [format, bytes] : {std::pair{"rgb16f", 6u}, {"rgba16f", 8u}, {"rgba8", 4u}, {"rgba32f", 16u}}) {
    const std::string spec = std::string("msaa:1,color=") + format;
    const FrameResult result = parse_technique(spec).render(trace, 0, {1});
    EXPECT_EQ(stage_of(result, "depth_test").bytes_written, stage_of(result, "depth_test").items_out * (4 + bytes));
    EXPECT_EQ(stage_of(result, "shade").bytes_written, stage_of(result, "shade").items_in * bytes) << spec;
    EXPECT_EQ(parse_technique(spec).framebuffer_bytes_per_pixel(), 4 + bytes);
  }
}

// A square moves by 2.5 pixels to the right in front of a wall that stands still. In the first frame nothing is known
// to have moved.
TEST(Msaa, MotionIsThatOfTheNearestSurface) {
  Trace trace = pixel_trace(16, 8, quad(-1, -1, 17, 9, 0.6, glm::vec3(0.5f)));
  trace.meshes.push_back(pixel_trace(1, 1, quad(2, 2, 6, 6, 0.3, glm::vec3(1))).meshes[0]);
  trace.frames[0].draws.emplace_back().mesh = 1;
  trace.frames.push_back(trace.frames[0]);
  trace.frames[1].draws[1].transform[3][0] = 2.5;
  for (const std::string n : {"1", "4"}) {
    for (const char* prepass : {"", ",prepass"}) {
      const std::string spec = "msaa:" + n + prepass;
      const Technique technique = parse_technique(spec + ",motion");
      ASSERT_TRUE(technique.keeps_history);
      History history;
      EXPECT_EQ(sum_of(technique.render(trace, 0, {1, &history}), "motion"), 0) << spec;
      const FrameResult second = technique.render(trace, 1, {1, &history});
      const std::vector<float>& moved = second.pixel_counters.at("motion");
      EXPECT_NEAR(moved[4 * 16 + 6], 2.5, 1e-3) << spec;
      EXPECT_EQ(moved[4 * 16 + 3], 0) << spec << ": the square has left this pixel";
      EXPECT_EQ(moved[4 * 16 + 12], 0) << spec;
      EXPECT_EQ(second.image.rgba, parse_technique(spec).render(trace, 1, {1}).image.rgba) << spec;
      const std::uint64_t samples = 16 * 8 * std::stoull(n);
      EXPECT_EQ(stage_of(second, "motion").items_in, samples) << spec;
      EXPECT_EQ(stage_of(second, "motion").bytes_read, 4 * samples) << spec << ": depths alone";
    }
  }
}

// Half of pixel (4, 4) shows a lamp of luminance 9, the other half white.
TEST(Msaa, ResolvesInReinhardsSpace) {
  std::vector<PixelSpaceTriangle> triangles = quad(-1, -1, 4.5, 9, 0.5, glm::vec3(9));
  append(triangles, quad(4.5, -1, 9, 9, 0.5, glm::vec3(1)));
  const Trace trace = pixel_trace(8, 8, triangles);
  const auto red = [&](const char* spec, std::size_t x) { return picture(spec, trace).rgba[4 * (4 * 8 + x)]; };
  EXPECT_NEAR(red("msaa:4,resolve=reinhard", 4), 7.0 / 3, 2e-3);
  EXPECT_NEAR(red("msaa:4", 4), 5, 2e-3);
  EXPECT_NEAR(red("msaa:4,resolve=reinhard", 2), 9, 2e-2) << "fp16";
}

TEST(Msaa, MoreSamplesComeNearerToTheReference) {
  const Trace trace = random_trace(48, 32, 400, 11);
  const Image reference = picture("reference", trace);
  double previous = rmse(picture("msaa:1", trace), reference);
  for (const char* spec : {"msaa:4", "msaa:16", "msaa:64", "msaa:256", "msaa:1024"}) {
    const double error = rmse(picture(spec, trace), reference);
    EXPECT_LT(error, 0.75 * previous) << spec;
    previous = error;
  }
  EXPECT_LT(previous, 1.5e-3);
}

// Triangles less than a pixel wide, around a corner of four quads. They cover no pixel's centre, but samples on both
// sides of a boundary, or in all four quads: 8 or 16 invocations for one triangle (the DVM article).
TEST(Msaa, ATriangleIsShadedInEveryQuadWhereItCoversASample) {
  const auto invocations = [](const char* spec, const PixelSpaceTriangle& triangle) {
    return stage_of(render(spec, pixel_trace(4, 4, {triangle})), "shade").lanes_issued;
  };
  const PixelSpaceTriangle in_two{{{1.6, 1.95, 0.5}, {2.3, 1.7, 0.5}, {2.3, 1.95, 0.5}}, glm::vec3(1)},
      in_four{{{1.6, 1.94, 0.5}, {2.3, 1.7, 0.5}, {2.4, 2.25, 0.5}}, glm::vec3(1)};
  for (const PixelSpaceTriangle& triangle : {in_two, in_four}) EXPECT_EQ(invocations("msaa:1", triangle), 0u);
  EXPECT_EQ(invocations("msaa:8", in_two), 8u);
  EXPECT_EQ(invocations("msaa:8", in_four), 16u);
}

}  // namespace beampipe::msaa_test
