#include "stages/geometry/vertex_setup.h"

#include <tbb/task_arena.h>

#include <glm/gtc/matrix_transform.hpp>

#include "tests/simd/random.h"
#include "tests/stages/vertex_scenes.h"

namespace beampipe::vertex_setup_test {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN(), kInfinity = std::numeric_limits<float>::infinity();

// Clip coordinates are positions (w = 1): x = -1 is the left border, y = +1 the upper one, z = -1 near and +1 far.
TEST(VertexSetup, ScreenPositionsInClosedForm) {
  const Scene scene = clip_space_scene({{0, 0, -1}, {0.5f, 0, 0}, {0, 0.75f, 1}});  // 64 x 32 px
  const SetupTriangles out = scene.setup();
  ASSERT_EQ(out.triangles.size(), 1u);
  const SetupTriangle& t = out.triangles[0];
  const auto expect_vertex = [&](std::int32_t x, std::int32_t y, float z) {
    for (int k = 0; k < 3; ++k)
      if (t.x[k] == x && t.y[k] == y && t.vertex_z[k] == z) return;
    ADD_FAILURE() << "no vertex at " << x << ", " << y << ", " << z;
  };
  expect_vertex(32 * 256, 16 * 256, -1.0f);
  expect_vertex(48 * 256, 16 * 256, -0.5f);
  expect_vertex(32 * 256, 4 * 256, 0.0f);  // y is smaller further up
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(t.depth.at(t.x[k] / 256.0, t.y[k] / 256.0), t.vertex_z[k], 1e-12);
  // Inside is where all edges are positive.
  for (int k = 0; k < 3; ++k) EXPECT_GT(edge_of(t, k).at(36 * 256, 14 * 256), 0);
}

TEST(VertexSetup, PerspectiveDividesByW) {
  Scene scene = clip_space_scene({{1, 1, -2}, {-1, 1, -2}, {0, -2, -4}}, 100, 100);
  scene.frame.projection = glm::perspective(2 * std::atan(0.5), 1.0, 1.0, 9.0);  // half the frame is 1/2 at distance 1
  const SetupTriangles out = scene.setup();
  ASSERT_EQ(out.triangles.size(), 1u);
  std::array<std::array<std::int32_t, 2>, 3> found;
  for (std::size_t k = 0; k < 3; ++k) found[k] = {out.triangles[0].x[k], out.triangles[0].y[k]};
  std::sort(found.begin(), found.end());
  // x / distance / (1/2) = 1, -1, 0; y likewise 1, 1, -1.
  const std::array<std::array<std::int32_t, 2>, 3> expected = {{{0, 0}, {50 * 256, 100 * 256}, {100 * 256, 0}}};
  EXPECT_EQ(found, expected);
  // Depth at distance d: ((f + n) / (f - n) - 2 f n / ((f - n) d) - 1) / 2 = (1 / 4 - 18 / (8 d)) / 2.
  const auto [near_z, far_z] =
      std::minmax({out.triangles[0].vertex_z[0], out.triangles[0].vertex_z[1], out.triangles[0].vertex_z[2]});
  EXPECT_NEAR(near_z, (0.25 - 18.0 / 16) / 2, 1e-7);
  EXPECT_NEAR(far_z, (0.25 - 18.0 / 32) / 2, 1e-7);
}

// A tie is rounded to the larger coordinate: round(x 256) = floor(x 256 + 1/2).
TEST(VertexSetup, SnapsToTheNearest256th) {
  const auto at = [](double units) { return static_cast<float>(units / 256 / 32 - 1); };  // in a frame of 64 px
  const Scene scene = clip_space_scene({{at(1000.5), 0, 0}, {at(2000.25), 0, 0}, {at(3000.75), 0.5f, 0}});
  const SetupTriangles out = scene.setup();
  ASSERT_EQ(out.triangles.size(), 1u);
  std::array<std::int32_t, 3> x = {out.triangles[0].x[0], out.triangles[0].x[1], out.triangles[0].x[2]};
  std::sort(x.begin(), x.end());
  EXPECT_EQ(x, (std::array<std::int32_t, 3>{1001, 2000, 3001}));
}

TEST(VertexSetup, DropsWhatCannotBeSeen) {
  const auto left = [](std::vector<glm::vec3> positions) {
    Scene scene = clip_space_scene(positions);  // 64 x 32 px
    const std::size_t found = scene.setup().triangles.size();
    // The same with a scissor that leaves out a border of one pixel, where none of these is seen.
    scene.frame.draws[0].state.scissor = Scissor{1, 1, 62, 30};
    EXPECT_EQ(scene.setup().triangles.size(), found)
        << positions[0].x << " " << positions[1].x << " " << positions[1].y;
    return found;
  };
  EXPECT_EQ(left({{0, 0, 0}, {0.5f, 0, 0}, {0, 0.5f, 0}}), 1u);
  for (const float bad : {kNaN, kInfinity, -kInfinity}) EXPECT_EQ(left({{0, 0, 0}, {0.5f, bad, 0}, {0, 0.5f, 0}}), 0u);
  EXPECT_EQ(left({{0, 0, 0}, {0.5f, 0, 0}, {0, 0.5f, kNaN}}), 0u);
  EXPECT_EQ(left({{0, 0, 0}, {0.25f, 0.25f, 0}, {0.5f, 0.5f, 0}}), 0u);   // a line
  EXPECT_EQ(left({{0, 0, 0}, {1e-6f, 0, 0}, {0, 1e-6f, 0}}), 0u);         // a point after snapping
  EXPECT_EQ(left({{2, 0, 0}, {3, 0, 0}, {2, 0.5f, 0}}), 0u);              // outside the frame
  EXPECT_EQ(left({{0, 0, 1.5f}, {0.5f, 0, 2}, {0, 0.5f, 1.5f}}), 0u);     // beyond the far plane
  EXPECT_EQ(left({{0, 0, -1.5f}, {0.5f, 0, -2}, {0, 0.5f, -1.5f}}), 0u);  // in front of the near plane
}

TEST(VertexSetup, CullsByTheWindingOnScreen) {
  const std::vector<glm::vec3> counter_clockwise = {{0, 0, 0}, {0.5f, 0, 0}, {0, 0.5f, 0}};
  const std::vector<glm::vec3> clockwise = {{0, 0, 0}, {0, 0.5f, 0}, {0.5f, 0, 0}};
  const auto left = [](const std::vector<glm::vec3>& positions, Cull cull, bool mirrored) {
    Scene scene = clip_space_scene(positions);
    scene.frame.draws[0].cull = cull;
    if (mirrored) scene.frame.draws[0].transform = glm::scale(glm::dmat4(1.0), glm::dvec3(-1, 1, 1));
    return scene.setup().triangles.size();
  };
  for (const bool mirrored : {false, true}) {
    const auto& front = mirrored ? clockwise : counter_clockwise;
    const auto& back = mirrored ? counter_clockwise : clockwise;
    for (const auto& [cull, fronts, backs] :
         {std::tuple{Cull::none, 1u, 1u}, {Cull::back, 1u, 0u}, {Cull::front, 0u, 1u}}) {
      EXPECT_EQ(left(front, cull, mirrored), fronts);
      EXPECT_EQ(left(back, cull, mirrored), backs);
    }
  }
}

// Copies of a triangle that start with another vertex or turn the other way have the same depth to the last bit. The
// rule that the earlier triangle wins a tie depends on it.
TEST(VertexSetup, DepthPlaneDoesNotDependOnTheOrderOfVertices) {
  Random random(151);
  for (int round = 0; round < 2'000; ++round) {
    std::vector<glm::vec3> positions;
    for (int k = 0; k < 3; ++k) positions.emplace_back(random.real(-1, 1), random.real(-1, 1), random.real(-1, 1));
    if (round % 3 == 0) positions[1].x = positions[0].x;
    if (round % 6 == 0) positions[1].y = positions[0].y, positions[1].x = positions[0].x + 0.01f;
    Scene scene = clip_space_scene(positions);
    Mesh& mesh = scene.trace.meshes[0];
    mesh.triangles = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
    mesh.colors.resize(6);
    const SetupTriangles out = scene.setup();
    if (out.triangles.empty()) continue;
    ASSERT_EQ(out.triangles.size(), 6u);
    for (const SetupTriangle& t : out.triangles) {
      const ScreenDepth &first = out.triangles[0].depth, &d = t.depth;
      ASSERT_EQ(std::tie(d.z, d.dzdx, d.dzdy, d.anchor_x, d.anchor_y),
                std::tie(first.z, first.dzdx, first.dzdy, first.anchor_x, first.anchor_y));
      ASSERT_GT(edge_of(t, 0).at(t.x[2], t.y[2]), 0);  // whichever way it turns
    }
  }
}

// Normals point towards the viewer, even if the draw, the view or the projection mirrors.
TEST(VertexSetup, LambertNormalsFaceTheViewer) {
  Random random(152);
  const glm::dvec3 eye(1, 2, 5);
  const auto mirror = [](bool yes, const glm::dvec3& axis) {
    return glm::scale(glm::dmat4(1.0), yes ? axis : glm::dvec3(1));
  };
  for (int round = 0; round < 400; ++round) {
    std::vector<glm::vec3> positions;
    for (int k = 0; k < 3; ++k) positions.emplace_back(random.real(-1, 1), random.real(-1, 1), random.real(-1, 1));
    Scene scene = clip_space_scene(positions);
    Draw& draw = scene.frame.draws[0];
    draw.shading = Shading::lambert;
    const bool draw_mirrored = round & 1, view_mirrored = round & 2, projection_mirrored = round & 4;
    draw.transform = mirror(draw_mirrored, {1, -1, 1});
    scene.frame.view = mirror(view_mirrored, {-1, 1, 1}) * glm::lookAt(eye, glm::dvec3(0), glm::dvec3(0, 1, 0));
    scene.frame.projection = mirror(projection_mirrored, {1, -1, 1}) * glm::perspective(1.0, 2.0, 0.1, 100.0);
    for (const FlatAttributes& flat : scene.setup().attributes) {
      const glm::dvec3 p = draw.transform * glm::dvec4(positions[0], 1.0);
      ASSERT_GT(glm::dot(glm::dvec3(flat.normal), eye - p), 0)
          << "mirrored: draw " << draw_mirrored << ", view " << view_mirrored << ", projection " << projection_mirrored;
      ASSERT_NEAR(glm::length(flat.normal), 1.0, 1e-6);
      ASSERT_TRUE(flat.lit);
    }
  }
}

TEST(VertexSetup, KdOfTheDrawReplacesTheMeshs) {
  Scene scene = clip_space_scene({{0, 0, 0}, {0.5f, 0, 0}, {0, 0.5f, 0}});
  scene.trace.meshes[0].colors = {{0.25f, 0.5f, 0.75f}};
  EXPECT_EQ(scene.setup().attributes.at(0).kd, glm::vec3(0.25f, 0.5f, 0.75f));
  scene.frame.draws[0].kd = glm::vec3(3.0f);
  EXPECT_EQ(scene.setup().attributes.at(0).kd, glm::vec3(3.0f));
}

// One thread writes straight to the frame's triangles; several put their parts together.
TEST(VertexSetup, TheNumberOfThreadsDoesNotMatter) {
  Random random(1);
  std::vector<glm::vec3> positions;
  for (int i = 0; i < 3 * 10'000; ++i)  // some beyond the near plane, the far plane or the border
    positions.emplace_back(random.real32(-1.1, 1.1), random.real32(-1.1, 1.1), random.real32(-1.1, 1.1));
  const Scene scene = clip_space_scene(positions);
  StageCounters counters[2];
  SetupTriangles found[2];
  for (int i = 0; i < 2; ++i) tbb::task_arena(i + 1).execute([&] { found[i] = vertex_setup_of(scene, counters[i]); });
  const auto& [one, two] = found;
  expect_same(one, two);
  EXPECT_GT(one.triangles.size(), 8'192u);  // more than two parts
  EXPECT_EQ(one.draws, two.draws);
  EXPECT_EQ(counters[0].items_out, counters[1].items_out);
  EXPECT_EQ(counters[0].bytes_written, counters[1].bytes_written);
}

}  // namespace beampipe::vertex_setup_test
