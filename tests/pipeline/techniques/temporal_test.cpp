// What taa and dvm have in common: history is found where the motion says, whatever the number of threads.

#include <glm/gtc/matrix_transform.hpp>

#include "tests/pipeline/techniques/render_frames.h"
#include "traces/files/trace_io.h"

namespace beampipe::temporal_test {

// Columns that are one pixel wide, each with a different grey.
Trace columns() {
  std::vector<PixelSpaceTriangle> triangles;
  for (int i = -8; i < 40; ++i)
    for (const auto& t : quad(i, -4, i + 1, 20, 0.5, glm::vec3(static_cast<float>((i * 37 & 15)) / 16.0f)))
      triangles.push_back(t);
  return pixel_trace(24, 8, triangles);
}

// The picture moves by one pixel to the right, so each pixel must find the history of its left neighbour.
void expect_shifted(const std::string& spec, const Trace& before, const Trace& after) {
  const Technique technique = parse_technique(spec);
  History history;
  const Image first = technique.render(before, 0, {1, &history}).image;
  const Image second = technique.render(after, 0, {1, &history}).image;
  for (std::uint32_t x = 2; x < 22; ++x) EXPECT_NEAR(red(second, x, 4), red(first, x - 1, 4), 2e-3) << spec << ' ' << x;
  EXPECT_EQ(history.frames, 2u);
}

TEST(Temporal, ReprojectionFollowsTheCameraAndDrawsUnderAStillOne) {
  Trace camera = columns(), draw = columns();
  camera.frames[0].view[3][0] = draw.frames[0].draws[0].transform[3][0] = 1;
  for (const Trace& after : {camera, draw})
    for (const char* spec : {"taa:1,blend=0.001", "dvm:blend=0.001"}) expect_shifted(spec, columns(), after);
}

TEST(Temporal, ReprojectionFollowsVertices) {
  Trace before = columns();
  before.meshes.push_back(before.meshes[0]);
  for (glm::vec3& at : before.meshes[1].positions) at.x += 1;
  Trace after = before;
  after.frames[0].draws[0].mesh = 1;
  for (const char* spec : {"taa:1,blend=0.001", "taa:1,blend=0.001,shading=forward", "dvm:blend=0.001"})
    expect_shifted(spec, before, after);
}

TEST(Temporal, FramesAreTheSameFromAnyNumberOfThreads) {
  const Trace trace = random_trace(147, 81, 200, 7);  // several tiles, and odd sizes
  for (const char* spec : {"taa:8", "dvm", "dvm:clamp=camera", "dvm:clamp=variance", "dvm:extra=4"})
    EXPECT_EQ(render_frames(spec, trace, 5).rgba, render_frames(spec, trace, 5, 3).rgba);
}

}  // namespace beampipe::temporal_test
