#include "tools/cli/framing.h"

#include "tests/tools/fixtures.h"

namespace beampipe::framing_test {

// A box from `low` to `high`.
Mesh box(glm::vec3 low, glm::vec3 high) {
  Mesh mesh;
  for (int i = 0; i < 8; ++i) {
    mesh.positions.emplace_back(i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z);
  }
  for (std::uint32_t i = 0; i < 8; ++i) mesh.triangles.emplace_back(i, (i + 1) % 8, (i + 3) % 8);
  mesh.colors.assign(mesh.triangles.size(), glm::vec3(0.8f));
  return mesh;
}

// The camera for one mesh that is drawn where it is.
Camera frame_mesh(const Mesh& mesh, std::uint32_t width, std::uint32_t height, const CameraWishes& wishes) {
  Trace trace;
  trace.meshes = {mesh};
  trace.frames.emplace_back().draws.emplace_back();
  return frame_model(trace, width, height, wishes);
}

// Over all vertices: the smallest w in clip space, the largest |x| / w or |y| / w, and the largest |z| / w.
struct Reach {
  double least_w = 1e300, across = 0, depth = 0;
};

Reach reach_of(const Mesh& mesh, const Camera& camera, std::uint32_t width, std::uint32_t height) {
  Frame frame;
  frame.width = width;
  frame.height = height;
  set_camera(frame, camera);
  Reach reach;
  for (const glm::vec3& position : mesh.positions) {
    const glm::dvec4 clip = frame.projection * frame.view * glm::dvec4(position, 1.0);
    reach.least_w = std::min(reach.least_w, clip.w);
    reach.across = std::max({reach.across, std::abs(clip.x / clip.w), std::abs(clip.y / clip.w)});
    reach.depth = std::max(reach.depth, std::abs(clip.z / clip.w));
  }
  return reach;
}

TEST(FrameMesh, FillsThePictureWithTheWholeModel) {
  const Mesh meshes[] = {box({-1, -1, -1}, {1, 1, 1}), box({100, 0, 0}, {101, 50, 1}),
                         box({-0.001f, 0, 0}, {0, 0.001f, 5}), box({-1, -1, 3}, {1, 1, 3})};
  for (const Mesh& mesh : meshes) {
    for (const auto& [width, height] : {std::pair<std::uint32_t, std::uint32_t>{320, 180}, {100, 400}, {64, 64}}) {
      const Reach reach = reach_of(mesh, frame_mesh(mesh, width, height, {}), width, height);
      EXPECT_GT(reach.least_w, 0);
      EXPECT_NEAR(reach.across, 0.95, 1e-9);
      EXPECT_LT(reach.depth, 1.0);
    }
  }
}

TEST(FrameMesh, KeepsWhatTheUserFixed) {
  CameraWishes wishes;
  wishes.eye = glm::dvec3(9, 8, 7);
  wishes.target = glm::dvec3(0.5, 0, 0);
  wishes.up = glm::dvec3(0, 0, 1);
  wishes.fovy_deg = 50;
  wishes.near = 0.25;
  wishes.far = 99;
  const Camera camera = frame_mesh(box({-1, -1, -1}, {1, 1, 1}), 320, 180, wishes);
  EXPECT_EQ(camera.eye, *wishes.eye);
  EXPECT_EQ(camera.target, *wishes.target);
  EXPECT_EQ(camera.up, *wishes.up);
  EXPECT_EQ(camera.fovy_deg, 50);
  EXPECT_EQ(camera.near, 0.25);
  EXPECT_EQ(camera.far, 99);
}

TEST(FrameMesh, ChoosesDepthsThatEncloseTheModelFromAnyEye) {
  const Mesh mesh = box({-1, -1, -1}, {1, 1, 1});
  for (const glm::dvec3& eye : {glm::dvec3(0, 0, 5), glm::dvec3(-400, 3, 2)}) {
    CameraWishes wishes;
    wishes.eye = eye;
    EXPECT_LT(reach_of(mesh, frame_mesh(mesh, 320, 180, wishes), 320, 180).depth, 1.0);
  }
  CameraWishes inside;
  inside.eye = glm::dvec3(0.5, 0, 0);
  const Camera camera = frame_mesh(mesh, 320, 180, inside);
  EXPECT_GT(camera.near, 0);
  EXPECT_LT(camera.near, 0.01);
  EXPECT_GT(camera.far, 1.5);
}

TEST(FrameMesh, RefusesWhatMakesNoCamera) {
  const Mesh mesh = box({-1, -1, -1}, {1, 1, 1});
  const auto frame = [&mesh](const CameraWishes& wishes) { return frame_mesh(mesh, 320, 180, wishes); };
  CameraWishes same, along, behind, angle, planes;
  same.eye = same.target = glm::dvec3(1, 2, 3);
  along.eye = glm::dvec3(0, 5, 0);
  behind.eye = glm::dvec3(0, 0, 5);
  behind.target = glm::dvec3(0, 0, 10);
  angle.fovy_deg = 180;
  planes.near = 5;
  planes.far = 5;
  for (const CameraWishes& wishes : {same, along, behind, angle, planes})
    EXPECT_THROW(frame(wishes), std::invalid_argument);
  EXPECT_THROW(frame_mesh(Mesh{}, 320, 180, {}), std::invalid_argument);
  EXPECT_THROW(frame_mesh(box({1, 1, 1}, {1, 1, 1}), 320, 180, {}), std::invalid_argument);
}

TEST(FrameModel, EnclosesAllDrawsOfAllFramesWhereTheyAre) {
  Trace trace;
  trace.meshes = {box({-1, -1, -1}, {1, 1, 1}), box({0, 0, 0}, {1, 1, 1})};
  for (double x : {3.0, 8.0}) {
    Draw draw;
    draw.transform[3][0] = x;
    trace.frames.emplace_back().draws = {Draw{}, draw};
    trace.frames.back().draws[1].mesh = 1;
  }
  CameraWishes wishes;
  wishes.from = {0.5, 0.3, 1.0};  // then the farthest corners of the bounds below are corners of the first box
  const Camera camera = frame_model(trace, 320, 180, wishes);
  EXPECT_EQ(camera.target, glm::dvec3(4, 0, 0));  // from -1 to 9
  const Reach reach = reach_of(box({-1, -1, -1}, {9, 1, 1}), camera, 320, 180);
  EXPECT_LE(reach.across, 0.95 + 1e-9);
  EXPECT_GT(reach.across, 0.8);
  EXPECT_LT(reach.depth, 1.05);
}

TEST(ShoulderLight, TravelsWithTheViewAndDown) {
  const Camera camera = frame_mesh(box({-1, -1, -1}, {1, 1, 1}), 320, 180, {});
  const glm::dvec3 light(shoulder_light(camera));
  EXPECT_NEAR(glm::length(light), 1.0, 1e-6);
  EXPECT_GT(glm::dot(light, glm::normalize(camera.target - camera.eye)), 0.5);
  EXPECT_LT(light.y, 0.0);
  // The sides of a box that face the camera are lit.
  for (int axis = 0; axis < 3; ++axis) {
    const double towards = camera.eye[axis] - camera.target[axis];
    EXPECT_LT(light[axis] * (towards > 0 ? 1 : -1), -0.3) << axis;
  }
}

}  // namespace beampipe::framing_test
