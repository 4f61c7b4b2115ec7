// Multisampling: samples that can be counted by hand, where fragments are shaded, and pictures.
#include <gtest/gtest.h>

#include "pipeline/technique.h"
#include "tests/pipeline/test_pictures.h"
#include "tests/pipeline/test_traces.h"

namespace beampipe {
namespace {

TEST(Msaa, CountsSamples) {
  const FrameResult one = parse_technique("msaa:1").render(half_square(), 0, {1});
  // Pixel centres (x + 1/2, y + 1/2) with x <= y and 1 <= x, y <= 4. Centres on the diagonal, which is a top right
  // edge, do not belong to the triangle.
  EXPECT_EQ(stage_of(one, "depth_test").items_in, 6u);
  EXPECT_EQ(stage_of(one, "depth_test").items_out, 6u);
  EXPECT_EQ(stage_of(one, "depth_test").bytes_written, 6u * 10);
  EXPECT_EQ(one.a_buffer_peak_bytes, 0u);
  const FrameResult eight = parse_technique("msaa:8").render(half_square(), 0, {1});
  EXPECT_EQ(stage_of(eight, "resolve").items_in, 64u * 8);
  EXPECT_GT(stage_of(eight, "depth_test").items_in, stage_of(one, "depth_test").items_in * 7);
}

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
    double moved = 0;
    for (const float count : centroid.pixel_counters.at("centroids")) moved += count;
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

}  // namespace
}  // namespace beampipe
