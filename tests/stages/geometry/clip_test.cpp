// vertex_setup's clipping to the near and far planes and to the guard band.
#include <glm/gtc/matrix_transform.hpp>

#include "tests/simd/random.h"
#include "tests/stages/sample_pixels.h"
#include "tests/stages/vertex_scenes.h"

namespace beampipe::clip_test {

constexpr std::int32_t kWidth = 48, kHeight = 32;

// Per sample: the number of front faces that cover it minus the number of back faces. If snapping folds a closed
// surface over itself, this number stays the same; a crack or an overlap changes it.
std::vector<int> winding(Scene scene) {
  const Sampling sampling{CellGrid{}, standard_pattern(16)};
  std::vector<int> sum(kWidth * kHeight * 16);
  for (const Cull cull : {Cull::back, Cull::front}) {
    for (Draw& draw : scene.frame.draws) draw.cull = cull;
    for (const SampleFragment& f : sample_fragments(scene.setup(), {0, 0, kWidth, kHeight}, sampling))
      for (std::int32_t s = 0; s < 16; ++s)
        sum[static_cast<std::size_t>((f.y * kWidth + f.x) * 16 + s)] +=
            static_cast<int>(f.mask >> s & 1) * (cull == Cull::back ? 1 : -1);
  }
  return sum;
}

// A floor of small triangles at y = 0 around a camera at height 1 that looks along -z. The floor extends behind the
// camera.
Scene floor_scene(Random& random, double near, double far, double tilt_deg) {
  constexpr int kCells = 40;
  Mesh mesh;
  for (int i = 0; i <= kCells; ++i)
    for (int j = 0; j <= kCells; ++j)
      mesh.positions.emplace_back((i - kCells / 2 + random.real(-0.3, 0.3)) * 0.4, 0.0,
                                  (j - kCells + 6 + random.real(-0.3, 0.3)) * 0.4);
  for (std::uint32_t i = 0; i < kCells; ++i)
    for (std::uint32_t j = 0; j < kCells; ++j) {
      const std::uint32_t a = i * (kCells + 1) + j, b = a + kCells + 1;
      mesh.triangles.emplace_back(a, a + 1, b);  // counter-clockwise from above
      mesh.triangles.emplace_back(b, a + 1, b + 1);
    }
  mesh.colors.resize(mesh.triangles.size());
  Scene scene = clip_space_scene({}, kWidth, kHeight);
  scene.trace.meshes[0] = mesh;
  const double tilt = glm::radians(tilt_deg);
  scene.frame.view = glm::lookAt(glm::dvec3(0, 1, 0), glm::dvec3(0, 1 - std::sin(tilt), -std::cos(tilt)),
                                 glm::dvec3(0, std::cos(tilt), -std::sin(tilt)));
  scene.frame.projection = glm::perspective(glm::radians(100.0), double(kWidth) / kHeight, near, far);
  return scene;
}

// The camera looks down. Every sample shows the floor, which consists of thousands of pieces; some are behind the
// camera or cross the near plane.
TEST(Clipping, FloorThroughTheNearPlaneIsWatertight) {
  Random random(161);
  for (const double near : {0.5, 0.1, 1e-3}) {
    const Scene scene = floor_scene(random, near, 100, 89);
    const std::vector<int> found = winding(scene);
    EXPECT_EQ(std::set<int>(found.begin(), found.end()), std::set<int>{1}) << "near " << near;
  }
}

// The camera looks along the floor. This clips to the near plane, to the guard band (vertices just in front of the
// camera are projected tens of thousands of pixels away) and, with far = 8, to the far plane. Every sample a few rows
// below the horizon is covered once; the others are covered once or not at all.
TEST(Clipping, FloorToTheHorizonIsWatertight) {
  Random random(162);
  for (const double near : {0.9, 0.1, 1e-5})
    for (const double far : {100.0, 8.0}) {
      const std::vector<int> found = winding(floor_scene(random, near, far, 0));
      const std::set<int> values(found.begin(), found.end());
      EXPECT_EQ(values, (std::set<int>{0, 1})) << near << ", " << far;
      // Half the frame is tan(50 deg) at distance 1. A floor point at distance d lies 16 px / (d tan 50) below the
      // middle. The near plane and the floor's edges (8 to the sides and 13 ahead, or far) limit what is covered.
      const double per_unit = kHeight / 2 / std::tan(glm::radians(50.0));
      const double highest = kHeight / 2 + per_unit / std::min(far, 12.5) + 1;
      const double lowest = kHeight / 2 + per_unit / near - 1;
      int checked = 0;
      for (std::int32_t i = 0; i < static_cast<std::int32_t>(found.size()); ++i) {
        const std::int32_t y = i / 16 / kWidth, x = i / 16 % kWidth;
        if (y < highest || y + 1 > lowest) continue;
        const double farthest = per_unit / (y - kHeight / 2);  // of the pixel's points
        if ((std::abs(x + 0.5 - kWidth / 2) + 0.5) * farthest / per_unit > 7.5) continue;
        ASSERT_EQ(found[static_cast<std::size_t>(i)], 1) << x << ", " << y << ", near " << near << ", far " << far;
        ++checked;
      }
      EXPECT_GT(checked, 5'000);
    }
}

// Neighbours run along their common edge in opposite directions, but must find the same crossing to the last bit. A
// plane's anchor is a vertex that is not yet snapped, in double precision.
TEST(Clipping, NeighboursGetTheSameCrossing) {
  Random random(164);
  int shared = 0;
  for (int round = 0; round < 4'000; ++round) {
    const auto point = [&](double z) { return glm::vec3(random.real(-1, 1), random.real(-1, 1), z); };
    const glm::vec3 seen = point(-2), behind = point(0.5);
    Scene scene = clip_space_scene({seen, behind, point(-3), behind, seen, point(-3)}, kWidth, kHeight);
    scene.frame.projection = glm::perspective(1.5, 1.5, 0.5, 100.0);
    scene.frame.draws[0].kd = glm::vec3(1.0f);
    const SetupTriangles out = scene.setup();
    for (const SetupTriangle& s : out.triangles)
      for (const SetupTriangle& t : out.triangles) {
        if (s.depth.anchor_x != t.depth.anchor_x || s.depth.anchor_y != t.depth.anchor_y) continue;
        if (&s == &t || std::abs(s.depth.z + 1) > 1e-9) continue;  // on the near plane
        ASSERT_EQ(s.depth.z, t.depth.z) << "round " << round;
        ++shared;
      }
  }
  EXPECT_GT(shared, 1'000);
}

TEST(Clipping, GiantTriangleCoversTheFrameFromWithinTheGuardBand) {
  for (const float size : {1e3f, 1e5f, 1e7f}) {
    const Scene scene = clip_space_scene({{-size, -size, 0}, {size, -size, 0}, {0, size, 0}}, kWidth, kHeight);
    const SetupTriangles out = scene.setup();
    ASSERT_GE(out.triangles.size(), 1u);
    for (const SetupTriangle& t : out.triangles)
      for (int k = 0; k < 3; ++k) {
        EXPECT_LE(std::abs(t.x[k]), 1 << 23);
        EXPECT_LE(std::abs(t.y[k]), 1 << 23);
      }
    EXPECT_EQ(out.attributes.size(), out.triangles.size());
    const std::vector<int> found = winding(scene);
    EXPECT_EQ(std::set<int>(found.begin(), found.end()), std::set<int>{1}) << size;
  }
}

TEST(Clipping, DepthStaysBetweenNearAndFar) {
  Random random(163);
  for (const SetupTriangle& t : floor_scene(random, 0.1, 8, 10).setup().triangles)
    for (const float z : t.vertex_z) {
      ASSERT_GE(z, -1.0f - 1e-6f);
      ASSERT_LE(z, 1e-6f);
    }
}

// One vertex is in front of the near plane, so two pieces remain. The polygon has 3 vertices at the near plane and 4 at
// each of the five other planes. Each test of a vertex is an inner product of 4 products and 3 sums, and a comparison;
// so are the tests that decided to clip. Each of two crossings is a quotient, 4 products and 9 sums. 3 comparisons test
// whether a piece is in front of the eye. The rest costs the same as for any triangle (SetupTwins).
TEST(Clipping, CountsPiecesAndPlaneTests) {
  StageCounters counters;
  const SetupTriangles out = vertex_setup_of(clip_space_scene({{0, 0, -2}, {0.5f, 0, 0}, {0, 0.5f, 0}}), counters);
  EXPECT_EQ(out.triangles.size(), 2u);
  EXPECT_EQ(counters.items_in, 1u);
  EXPECT_EQ(counters.items_out, 2u);
  const std::uint64_t tests = 6 * 3 + 3 + 5 * 4;
  const std::uint64_t projected = 2 + 2 * 3;  // vertices in view, and the vertices of the pieces
  EXPECT_EQ(counters.ops,
            (OperationCounts{.mul_add = 36 + projected * 12 + 2 * (2 + 8) + 4 * tests + 2 * 4,
                             .add = 36 + 12 + 21 + projected * 5 + 2 * (3 + 6 + 3 + 9) + 4 * tests + 2 * 9,
                             .bit = 9,
                             .special = projected + 2 + 2,
                             .convert = projected * 4 + 2 * 3}));
}

}  // namespace beampipe::clip_test
