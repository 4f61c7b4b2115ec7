#include "tools/cli/viewpoint.h"

#include <numbers>

#include "tests/tools/fixtures.h"
#include "tools/cli/sight.h"

namespace beampipe::viewpoint_test {

enum class Faces { outwards, inwards };

// Adds a box from -size / 2 to size / 2 without the sides in `open`: 0 to 5 for -x, +x, -y, +y, -z and +z.
void add_box(Mesh& mesh, const glm::vec3& size, Faces faces, const std::vector<int>& open = {}) {
  for (int side = 0; side < 6; ++side) {
    if (std::count(open.begin(), open.end(), side) > 0) continue;
    const int axis = side / 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
    const bool is_high = side % 2 == 1;
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (int k = 0; k < 4; ++k) {  // counter-clockwise from +axis
      glm::vec3 corner = size * 0.5f;
      if (!is_high) corner[axis] = -corner[axis];
      if (k == 0 || k == 3) corner[u] = -corner[u];
      if (k < 2) corner[v] = -corner[v];
      mesh.positions.push_back(corner);
    }
    const bool turns = is_high != (faces == Faces::outwards);
    for (const glm::uvec3 t : {glm::uvec3(0, 1, 2), {0, 2, 3}})
      mesh.triangles.push_back(first + (turns ? glm::uvec3(t.x, t.z, t.y) : t));
  }
}

Trace trace_of(Mesh mesh) {
  mesh.colors.assign(mesh.triangles.size(), kDefaultColor);
  Trace trace;
  trace.meshes = {std::move(mesh)};
  trace.frames.emplace_back().draws.emplace_back();
  return trace;
}

Trace room(const std::vector<int>& open, Faces faces = Faces::inwards) {
  Mesh mesh;
  add_box(mesh, {8, 5, 10}, faces, open);
  return trace_of(std::move(mesh));
}

Viewpoint view(const Trace& trace, const CameraWishes& wishes = {}, std::optional<Standpoint> asked = {}) {
  return choose_viewpoint(trace, 320, 180, wishes, asked);
}

bool is_within(const glm::dvec3& eye, const glm::dvec3& half) { return glm::all(glm::lessThan(glm::abs(eye), half)); }

TEST(Viewpoint, IsInsideOfARoomWhoseWallsFaceInwards) {
  const Trace trace = room({});
  for (const auto& [width, height] : {std::pair<std::uint32_t, std::uint32_t>{320, 180}, {100, 400}, {64, 64}}) {
    const Viewpoint viewpoint = choose_viewpoint(trace, width, height, {}, {});
    EXPECT_EQ(viewpoint.standpoint, Standpoint::inside);
    EXPECT_TRUE(is_within(viewpoint.camera.eye, {4, 2.5, 5}));
    for (const FirstSurface& pixel : sight_from(trace, trace.frames[0], viewpoint.camera, 16, 9).pixels) {
      EXPECT_TRUE(std::isfinite(pixel.depth));
      EXPECT_FALSE(pixel.is_back);
    }
  }
}

TEST(Viewpoint, IsOutsideOfABoxWhoseSidesFaceOutwards) {
  const Viewpoint viewpoint = view(room({}, Faces::outwards));
  EXPECT_EQ(viewpoint.standpoint, Standpoint::outside);
  EXPECT_EQ(viewpoint.camera.eye, frame_model(room({}, Faces::outwards), 320, 180, {}).eye);
}

TEST(Viewpoint, LooksThroughTheOpenSideOfARoom) {
  const struct {
    int side;
    glm::dvec3 from;
  } sides[] = {{0, {-1, 0, 0}}, {1, {1, 0, 0}}, {4, {0, 0, -1}}, {5, {0, 0, 1}}};
  for (const auto& [side, from] : sides) {
    const Viewpoint viewpoint = view(room({side}));
    EXPECT_EQ(viewpoint.standpoint, Standpoint::open_side) << side;
    EXPECT_NEAR(glm::distance(glm::normalize(viewpoint.camera.eye), from), 0, 1e-12) << side;
    EXPECT_FALSE(is_within(viewpoint.camera.eye, {4, 2.5, 5})) << side;
  }
}

TEST(Viewpoint, IsInsideOfARoomThatIsOpenAbove) { EXPECT_EQ(view(room({3})).standpoint, Standpoint::inside); }

TEST(Viewpoint, FollowsWhatIsUp) {
  CameraWishes wishes;
  wishes.up = glm::dvec3(0, 0, 1);
  const Viewpoint viewpoint = view(room({3}), wishes);  // open to the back, which is +y
  EXPECT_EQ(viewpoint.standpoint, Standpoint::open_side);
  EXPECT_GT(viewpoint.camera.eye.y, 2.5);
  const glm::dvec3 eye = view(room({}, Faces::outwards), wishes).camera.eye;
  EXPECT_LT(eye.x, 0);
  EXPECT_LT(eye.y, -std::abs(eye.z));
  EXPECT_GT(eye.z, 0);
}

// Their winding says nothing: they do not fill their bounds as walls do.
TEST(Viewpoint, IsOutsideOfObjectsThatAreInsideOut) {
  Mesh ball;
  constexpr int kAround = 24;
  for (int i = 0; i <= kAround; ++i)
    for (int k = 0; k < kAround; ++k) {
      const double a = std::numbers::pi * i / kAround, b = 2 * std::numbers::pi * k / kAround;
      ball.positions.emplace_back(std::sin(a) * std::cos(b), std::cos(a), std::sin(a) * std::sin(b));
    }
  const auto vertex = [](int i, int k) { return static_cast<std::uint32_t>(i * kAround + k % kAround); };
  for (int i = 0; i < kAround; ++i)
    for (int k = 0; k < kAround; ++k) {
      ball.triangles.emplace_back(vertex(i, k), vertex(i + 1, k), vertex(i + 1, k + 1));
      ball.triangles.emplace_back(vertex(i, k), vertex(i + 1, k + 1), vertex(i, k + 1));
    }
  const Trace trace = trace_of(std::move(ball));
  int backs = 0;
  const Camera camera = frame_model(trace, 64, 64, {});
  for (const FirstSurface& pixel : sight_from(trace, trace.frames[0], camera, 16, 16).pixels) backs += pixel.is_back;
  EXPECT_GT(backs, 100) << "otherwise this test shows nothing";
  EXPECT_EQ(view(trace).standpoint, Standpoint::outside);
}

TEST(Viewpoint, IsOutsideOfLeavesThatFaceEverywhere) {
  std::mt19937 random(1);
  const auto number = [&random] { return static_cast<float>(random()) / 4294967296.0f - 0.5f; };
  Mesh leaves;
  for (std::uint32_t i = 0; i < 3000; i += 3) {
    const glm::vec3 place(10 * number(), 10 * number(), 10 * number());
    for (int k = 0; k < 3; ++k) leaves.positions.push_back(place + glm::vec3(number(), number(), number()));
    leaves.triangles.emplace_back(i, i + 1, i + 2);
  }
  EXPECT_EQ(view(trace_of(std::move(leaves))).standpoint, Standpoint::outside);
}

// Of the places in a room, those are best that see the furniture.
TEST(Viewpoint, LooksAtWhatIsInTheRoom) {
  for (const double x : {-3.0, 3.0}) {
    Trace trace = room({});
    Mesh things;
    for (int i = 0; i < 20; ++i) {
      add_box(things, {0.3, 0.3, 0.3}, Faces::outwards);
      for (std::size_t v = things.positions.size() - 24; v < things.positions.size(); ++v)
        things.positions[v] += glm::vec3(x, -2.3f, -4.5f + 0.45f * static_cast<float>(i));
    }
    things.colors.assign(things.triangles.size(), kDefaultColor);
    trace.meshes.push_back(things);
    trace.frames[0].draws.push_back({.mesh = 1});
    const Viewpoint viewpoint = view(trace);
    EXPECT_EQ(viewpoint.standpoint, Standpoint::inside);
    EXPECT_LT(viewpoint.camera.eye.x * x, 0) << "it stands on the other side";
  }
}

TEST(Viewpoint, StandsWhereTheUserSays) {
  const Viewpoint outside = view(room({}), {}, Standpoint::outside);
  EXPECT_EQ(outside.standpoint, Standpoint::outside);
  EXPECT_EQ(outside.camera.eye, frame_model(room({}), 320, 180, {}).eye);
  CameraWishes wishes;
  wishes.target = glm::dvec3(3.9, 0, 0);
  wishes.fovy_deg = 20;
  const Viewpoint inside = view(room({}, Faces::outwards), wishes, Standpoint::inside);
  EXPECT_EQ(inside.standpoint, Standpoint::inside);
  EXPECT_TRUE(is_within(inside.camera.eye, {4, 2.5, 5}));
  EXPECT_EQ(inside.camera.target, *wishes.target);
  EXPECT_EQ(inside.camera.fovy_deg, 20);
}

TEST(Viewpoint, RefusesToStandInsideOfAPlane) {
  Mesh plane;
  add_box(plane, {4, 0, 4}, Faces::outwards, {0, 1, 2, 4, 5});
  const Trace trace = trace_of(std::move(plane));
  EXPECT_EQ(view(trace).standpoint, Standpoint::outside);
  EXPECT_THROW(view(trace, {}, Standpoint::inside), std::invalid_argument);
}

}  // namespace beampipe::viewpoint_test
