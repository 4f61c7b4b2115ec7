// Temporal antialiasing.

#include <glm/gtc/matrix_transform.hpp>

#include "tests/pipeline/techniques/render_frames.h"
#include "traces/files/trace_io.h"

namespace beampipe::taa_test {

TEST(Taa, TheFirstFrameIsOneSample) {
  const Trace trace = random_trace(40, 30, 100, 2);
  EXPECT_LT(worst_difference(render_frames("taa:1", trace, 1), render_frames("msaa:1", trace, 1)), 0x1p-11);
}

// In every frame; forward shading rounds a sample's colour to fp16.
TEST(Taa, ThePictureIsTheSameHoweverAFrameIsShaded) {
  const Trace trace = random_trace(40, 30, 100, 2);
  for (const std::size_t frames : {1u, 5u}) {
    const Image visibility = render_frames("taa:8", trace, frames);
    EXPECT_EQ(render_frames("taa:8,shading=deferred", trace, frames).rgba, visibility.rgba);
    EXPECT_LT(worst_difference(render_frames("taa:8,shading=forward", trace, frames), visibility), 0x1p-9);
  }
}

// Forward shading runs in whole quads, and motion reads nothing but depth.
TEST(Taa, CountsHowAFrameIsShaded) {
  const FrameResult forward = render("taa:1,shading=forward", half_square());
  EXPECT_EQ(stage_of(forward, "shade").lanes_issued, 4u * 4);
  EXPECT_EQ(stage_of(forward, "motion").bytes_read, 64u * 4);
  const FrameResult deferred = render("taa:1,shading=deferred", half_square());
  EXPECT_EQ(stage_of(deferred, "shade").lanes_issued, 4u * 4);
  EXPECT_EQ(stage_of(deferred, "light").items_in, 6u);
  EXPECT_EQ(stage_of(deferred, "motion").bytes_read, 64u * 4);
  const FrameResult visibility = render("taa:1", half_square());
  EXPECT_EQ(stage_of(visibility, "shade").lanes_issued, 6u);
  EXPECT_EQ(stage_of(visibility, "material_sort").items_out, 6u);
  EXPECT_EQ(stage_of(visibility, "motion").bytes_read, 64u * (4 + 4));
}

TEST(Taa, AnEdgeAccumulatesToItsCoverage) {
  // The edge at x = 8.5 lies between wide areas, so the clamp's box contains the colours of both.
  const Trace trace = pixel_trace(16, 8, quad(-4, -4, 8.5, 20, 0.5, glm::vec3(1)));
  const double found = red(render_frames("taa:8", trace, 64), 8, 4);
  EXPECT_NEAR(found, 0.5, 0.12);  // with T = 0.1 and a cycle of 8 frames the value still varies
  EXPECT_NEAR(red(render_frames("taa:8", trace, 1), 8, 4), 0.0, 1e-6);  // the first position is right of the edge
}

TEST(Taa, BlendIsExponential) {
  // Stripes that are black in the first frame are white in the later ones, and the other way round. The clamp never
  // acts, because its box contains both colours. After n frames, a pixel has gone 1 - (1 - T)^n of the way.
  std::vector<PixelSpaceTriangle> before, after;
  for (int i = 0; i < 8; ++i) {
    for (const auto& t : quad(i, 0, i + 1, 8, 0.5, glm::vec3(i % 2 ? 1.0f : 0.0f))) before.push_back(t);
    for (const auto& t : quad(i, 0, i + 1, 8, 0.5, glm::vec3(i % 2 ? 0.0f : 1.0f))) after.push_back(t);
  }
  Trace trace = pixel_trace(8, 8, before);
  const Trace other = pixel_trace(8, 8, after);
  const Technique technique = parse_technique("taa:1,blend=0.25");
  History history;
  technique.render(trace, 0, {1, &history});
  Image image;
  for (int i = 0; i < 3; ++i) image = technique.render(other, 0, {1, &history}).image;
  EXPECT_NEAR(red(image, 3, 4), std::pow(0.75, 3), 1e-3);
  EXPECT_NEAR(red(image, 4, 4), 1 - std::pow(0.75, 3), 1e-3);
}

TEST(Taa, AnotherSizeOfFrameStartsAfresh) {
  const Technique technique = parse_technique("taa:8");
  History history;
  technique.render(random_trace(40, 30, 100, 2), 0, {1, &history});
  const Trace smaller = random_trace(20, 30, 50, 3);
  const Image image = technique.render(smaller, 0, {1, &history}).image;
  EXPECT_EQ(image.rgba.size(), 4u * 20 * 30);
  EXPECT_EQ(history.width, 20);
}

}  // namespace beampipe::taa_test
