#include "tests/test.h"
#include "traces/trace.h"

namespace beampipe::camera_test {

// Where a point lands, in pixels from the upper left corner.
glm::dvec2 landing(const Frame& frame, const glm::dvec3& point) {
  const glm::dvec4 clip = frame.projection * frame.view * glm::dvec4(point, 1.0);
  return {(clip.x / clip.w + 1) / 2 * frame.width, (1 - clip.y / clip.w) / 2 * frame.height};
}

TEST(PanPicture, EveryPointMovesByTheSamePixelsAtEveryDepth) {
  Trace trace;
  Frame& first = trace.frames.emplace_back();
  first.width = 320, first.height = 180;
  set_camera(first, {.eye = {0, 1, 5}, .target = {0, 0, 0}, .up = {0, 1, 0}, .fovy_deg = 40, .near = 1, .far = 20});
  const Frame given = first;
  pan_picture(trace, 5, 0.25, -0.125);
  ASSERT_EQ(trace.frames.size(), 5u);
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_FALSE(trace.frames[i].camera.has_value());
    for (const glm::dvec3& point : {glm::dvec3(0, 0, 0), glm::dvec3(1, -0.5, 2), glm::dvec3(-2, 1, -9)}) {
      const glm::dvec2 moved = landing(trace.frames[i], point) - landing(given, point);
      EXPECT_NEAR(moved.x, 0.25 * static_cast<double>(i), 1e-9);
      EXPECT_NEAR(moved.y, -0.125 * static_cast<double>(i), 1e-9);
    }
  }
}

}  // namespace beampipe::camera_test
