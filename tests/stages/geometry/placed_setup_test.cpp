// vertex_setup of draws with homogeneous positions and fixed-function state.
#include <glm/gtc/matrix_transform.hpp>

#include "stages/geometry/setup_formulas.h"
#include "tests/simd/random.h"
#include "tests/stages/sample_pixels.h"
#include "tests/stages/vertex_scenes.h"

namespace beampipe::placed_setup_test {

constexpr std::int32_t kWidth = 48, kHeight = 32, kSamples = 16;

DrawState& state_of(Scene& scene) { return scene.frame.draws[0].state; }

std::vector<glm::vec3> random_positions(Random& random, int triangles, double reach) {
  std::vector<glm::vec3> positions;
  for (int i = 0; i < 3 * triangles; ++i)
    positions.emplace_back(random.real(-reach, reach), random.real(-reach, reach), random.real(-1.2, 1.2));
  return positions;
}

// A position times a power of two is the same position, to the last bit. Where triangles are clipped, only if all of
// their corners are multiplied alike: crossing points depend on w.
TEST(PlacedSetup, HomogeneousPositionsAreDividedByW) {
  Random random(331);
  for (int round = 0; round < 100; ++round) {
    const bool is_clipped = round % 2 == 0;
    Scene plain = clip_space_scene(random_positions(random, 20, is_clipped ? 3 : 0.5), kWidth, kHeight);
    plain.frame.draws[0].shading = Shading::lambert;
    const double distance = is_clipped ? random.real(1, 4) : random.real(3, 6);
    plain.frame.draws[0].transform = glm::translate(glm::dmat4(1), glm::dvec3(0.1, 0.2, -distance));
    plain.frame.projection = glm::perspective(1.5, 1.5, 0.5, 20.0);
    Scene scaled = plain;
    Mesh& mesh = scaled.trace.meshes[0];
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
      const bool is_new = !is_clipped || i % 3 == 0;
      mesh.ws.push_back(is_new ? random.pick(std::array{0.25f, 0.5f, 1.0f, 2.0f, 64.0f}) : mesh.ws.back());
      mesh.positions[i] *= mesh.ws.back();
    }
    StageCounters counters, scaled_counters;
    expect_same(vertex_setup_of(plain, counters), vertex_setup_of(scaled, scaled_counters));
    EXPECT_EQ(scaled_counters.bytes_read, counters.bytes_read + 60 * 4);
    // The products of w with a column of the matrix.
    EXPECT_EQ(scaled_counters.ops.mul_add, counters.ops.mul_add + 60 * 4);
    EXPECT_EQ(scaled_counters.ops.add, counters.ops.add);
  }
}

// An identity, so that clip space is the mesh's: a triangle behind the eye, and one that reaches behind it. What is in
// front of the eye has y >= 0 there, and goes up without end.
TEST(PlacedSetup, HomogeneousPositionsMayLieBehindTheEye) {
  Scene scene = clip_space_scene({{0, 0, 0}, {0.5f, 0, 0}, {0, 0.5f, 0}, {0, 0, 0}, {0.5f, 0, 0}, {0, 0.5f, 0}});
  scene.trace.meshes[0].ws = {-1, -1, -1, 1, 1, -1};
  const SetupTriangles out = scene.setup();
  ASSERT_GE(out.triangles.size(), 2u);
  std::int32_t highest = 0;
  for (const SetupTriangle& t : out.triangles)
    for (int k = 0; k < 3; ++k) {
      EXPECT_LE(t.y[k], 16 * 256);
      highest = std::min(highest, t.y[k]);
    }
  EXPECT_LT(highest, -30'000 * 256);
}

TEST(PlacedSetup, ViewportsPlaceTheClipVolume) {
  Random random(332);
  for (int round = 0; round < 200; ++round) {
    Scene scene = clip_space_scene(random_positions(random, 1, 1), 64, 32);
    for (glm::vec3& p : scene.trace.meshes[0].positions) p.z = std::clamp(p.z, -1.0f, 1.0f);
    Viewport view{random.real32(0, 20), random.real32(0, 10), random.real32(1, 44), random.real32(1, 22)};
    const bool upside_down = random.one_in(2);
    if (upside_down) view.y += view.height, view.height = -view.height;
    state_of(scene).viewport = view;
    const SetupTriangles out = scene.setup();
    if (out.triangles.empty()) continue;  // no area on the grid
    ASSERT_EQ(out.triangles.size(), 1u);
    const SetupTriangle& t = out.triangles[0];
    for (const glm::vec3& p : scene.trace.meshes[0].positions) {
      const double x = view.x + view.width * (1 + double{p.x}) / 2, y = view.y + view.height * (1 - double{p.y}) / 2;
      int found = 0;
      for (int k = 0; k < 3; ++k)
        found += std::abs(t.x[k] - 256 * x) < 0.5001 && std::abs(t.y[k] - 256 * y) < 0.5001 &&
                 std::abs(t.vertex_z[k] - (p.z - 1) / 2) < 1e-7;
      EXPECT_GE(found, 1) << "round " << round;
    }
    // Front faces are counter-clockwise in the picture.
    scene.frame.draws[0].cull = Cull::back;
    EXPECT_EQ(scene.setup().triangles.size(), t.front ? 1u : 0u);
    state_of(scene).front_is_clockwise = true;
    EXPECT_EQ(scene.setup().triangles.size(), t.front ? 0u : 1u);
  }
}

// The depths of a frame's samples, one triangle drawn alone; 2 where it covers nothing.
std::vector<float> depths_of(const SetupTriangles& triangles) {
  const Sampling sampling{CellGrid{}, standard_pattern(kSamples)};
  std::vector<float> depths(kWidth * kHeight * kSamples, 2.0f);
  for (const SampleFragment& f : sample_fragments(triangles, {0, 0, kWidth, kHeight}, sampling))
    for (std::int32_t s = 0; s < kSamples; ++s)
      if (f.mask >> s & 1) {
        const auto i = static_cast<std::size_t>(s);
        const double x = f.x + sampling.pattern.x[i] / 256.0, y = f.y + sampling.pattern.y[i] / 256.0;
        float& depth = depths[static_cast<std::size_t>((f.y * kWidth + f.x) * kSamples + s)];
        EXPECT_EQ(depth, 2.0f) << "pieces of a triangle overlap";
        depth = static_cast<float>(triangles.triangles[f.triangle].depth.at(x, y));
      }
  return depths;
}

// Is the sample within `reach` 1/256 px of an edge's line?
bool is_near_edge(const SetupTriangles& triangles, std::int64_t x, std::int64_t y, double reach) {
  for (const SetupTriangle& t : triangles.triangles)
    for (int k = 0; k < 3; ++k) {
      const Edge edge = edge_of(t, k);
      const double length = std::hypot(double(edge.a), double(edge.b));
      if (std::abs(static_cast<double>(edge.at(x, y))) <= reach * length) return true;
    }
  return false;
}

// Pixels outside the rectangle are not touched, and inside nothing changes but what the snapping of crossing points
// moves: about one unit of the grid.
TEST(PlacedSetup, ScissorsCutExactly) {
  Random random(333);
  const SamplePattern pattern = standard_pattern(kSamples);
  int inside = 0, outside = 0, cut = 0;
  for (int round = 0; round < 400; ++round) {
    Scene scene =
        clip_space_scene(random_positions(random, 1, random.pick(std::array{0.7, 2.0, 40.0})), kWidth, kHeight);
    for (glm::vec3& p : scene.trace.meshes[0].positions) p.z = std::clamp(p.z, -1.0f, 1.0f);
    scene.frame.projection[0][3] = random.real(-0.3, 0.3);  // w is 1 + a x
    const SetupTriangles whole = scene.setup();
    const std::int32_t x0 = random.int32(-5, kWidth), y0 = random.int32(-5, kHeight);
    const std::int32_t x1 = random.int32(x0, kWidth + 5), y1 = random.int32(y0, kHeight + 5);
    state_of(scene).scissor = Scissor{x0, y0, static_cast<std::uint32_t>(x1 - x0), static_cast<std::uint32_t>(y1 - y0)};
    const SetupTriangles clipped = scene.setup();
    for (const SetupTriangle& t : clipped.triangles)
      for (int k = 0; k < 3; ++k) {
        ASSERT_TRUE((x0 <= 0 || t.x[k] >= 256 * x0) && (x1 >= kWidth || t.x[k] <= 256 * x1)) << "round " << round;
        ASSERT_TRUE((y0 <= 0 || t.y[k] >= 256 * y0) && (y1 >= kHeight || t.y[k] <= 256 * y1)) << "round " << round;
      }
    cut += clipped.triangles.size() != whole.triangles.size();
    const std::vector<float> before = depths_of(whole), after = depths_of(clipped);
    for (std::int32_t i = 0; i < static_cast<std::int32_t>(before.size()); ++i) {
      const std::int32_t x = i / kSamples % kWidth, y = i / kSamples / kWidth;
      const auto at = static_cast<std::size_t>(i), s = static_cast<std::size_t>(i % kSamples);
      if (x < x0 || y < y0 || x >= x1 || y >= y1) {
        ASSERT_EQ(after[at], 2.0f) << "round " << round << ", " << x << ", " << y;
        outside += before[at] != 2.0f;
      } else if (!is_near_edge(whole, x * 256 + pattern.x[s], y * 256 + pattern.y[s], 1.5)) {
        ASSERT_EQ(after[at] == 2.0f, before[at] == 2.0f) << "round " << round << ", " << x << ", " << y;
        inside += before[at] != 2.0f;
      }
    }
  }
  EXPECT_GT(inside, 10'000);
  EXPECT_GT(outside, 10'000);
  EXPECT_GT(cut, 20);
}

// Fractional viewports end at the nearest 1/256 px; the crossing points lie there exactly.
TEST(PlacedSetup, CrossingPointsLieOnTheRectangle) {
  Random random(334);
  int on_sides = 0;
  for (int round = 0; round < 300; ++round) {
    Scene scene = clip_space_scene({{-9, -9, 0}, {9, -9, 0.5f}, {0, 12, -0.5f}}, kWidth, kHeight);
    const Viewport view{random.real32(1, 20), random.real32(1, 10), random.real32(1, 20), random.real32(1, 20)};
    state_of(scene).viewport = view;
    const auto grid = [](double pixels) { return static_cast<std::int32_t>(std::floor(256 * pixels + 0.5)); };
    const std::int32_t left = grid(view.x), right = grid(double{view.x} + view.width);
    const std::int32_t top = grid(view.y), bottom = grid(double{view.y} + view.height);
    std::int64_t area2 = 0;
    for (const SetupTriangle& t : scene.setup().triangles) {
      for (int k = 0; k < 3; ++k) on_sides += t.x[k] == left || t.x[k] == right || t.y[k] == top || t.y[k] == bottom;
      area2 += twice_area({t.x[0], t.y[0]}, {t.x[1], t.y[1]}, {t.x[2], t.y[2]});
    }
    // The triangle covers all of the viewport.
    EXPECT_EQ(area2, 2 * std::int64_t{right - left} * (bottom - top)) << "round " << round;
  }
  EXPECT_GT(on_sides, 1'000);
}

// Without depth clipping, a triangle has the depth of its plane, limited to -1..0, and the same coverage.
TEST(PlacedSetup, DepthIsLimitedWhereItIsNotClipped) {
  Random random(335);
  int limited = 0, checked = 0;
  for (int round = 0; round < 200; ++round) {
    const std::vector<glm::vec3> positions = random_positions(random, 1, 0.9);
    Scene flat = clip_space_scene(positions, kWidth, kHeight), scene = flat;
    for (glm::vec3& p : flat.trace.meshes[0].positions) p.z *= 0.5f;  // all of it is within the clip volume
    state_of(scene).depth.clip = false;
    for (glm::vec3& p : scene.trace.meshes[0].positions) p.z *= 3;
    const SetupTriangles whole = flat.setup(), split = scene.setup();
    if (whole.triangles.empty()) continue;
    const std::vector<float> plane = depths_of(whole), found = depths_of(split);
    for (std::int32_t i = 0; i < static_cast<std::int32_t>(plane.size()); ++i) {
      const std::int32_t x = i / kSamples % kWidth, y = i / kSamples / kWidth;
      const auto at = static_cast<std::size_t>(i), s = static_cast<std::size_t>(i % kSamples);
      const SamplePattern pattern = standard_pattern(kSamples);
      if (is_near_edge(whole, x * 256 + pattern.x[s], y * 256 + pattern.y[s], 2.0)) continue;
      ASSERT_EQ(found[at] == 2.0f, plane[at] == 2.0f) << "round " << round << ", " << x << ", " << y;
      if (plane[at] == 2.0f) continue;
      const double z = 6 * (2 * double{plane[at]} + 1), expected = (std::clamp(z, -1.0, 1.0) - 1) / 2;
      // Snapping tilts the plane of a small piece.
      const SetupTriangle& t = whole.triangles[0];
      const double slope = 6 * (std::abs(t.depth.dzdx) + std::abs(t.depth.dzdy));
      ASSERT_NEAR(found[at], expected, 1e-5 + slope / 64) << "round " << round << ", " << x << ", " << y;
      ++checked, limited += z < -1 || z > 1;
    }
  }
  EXPECT_GT(checked, 10'000);
  EXPECT_GT(limited, 1'000);
}

TEST(PlacedSetup, DepthBiasIsAddedToThePlane) {
  // Depth rises by 1/64 of the window's depth per pixel in x, and by half as much in y.
  const auto plane = [](float x, float y) {
    return glm::vec3(x, y, x - 0.25f * y);
  };  // 48 x 32 pixels: z / 2 per 24, 16
  Scene scene = clip_space_scene({plane(-0.5f, -0.5f), plane(0.5f, -0.5f), plane(0, 0.5f)}, kWidth, kHeight);
  const SetupTriangle before = scene.setup().triangles.at(0);
  const double slope = std::max(std::abs(before.depth.dzdx), std::abs(before.depth.dzdy));
  EXPECT_NEAR(slope, 1.0 / kWidth, 1e-4);
  const auto shift = [&](const DepthBias& bias, Compare function) {
    state_of(scene).depth.bias = bias, state_of(scene).depth.function = function;
    const SetupTriangle after = scene.setup().triangles.at(0);
    const double direction = function == Compare::greater ? -1 : 1;
    const double z = function == Compare::greater ? -1 - before.depth.z : before.depth.z;
    for (int k = 0; k < 3; ++k)
      EXPECT_NEAR(after.vertex_z[k] - after.depth.z, direction * (before.vertex_z[k] - before.depth.z), 1e-6);
    EXPECT_EQ(after.depth.dzdx, direction * before.depth.dzdx);
    return direction * (after.depth.z - z);
  };
  for (const Compare function : {Compare::less, Compare::greater}) {
    const std::pair<DepthBias, double> cases[] = {{{0.125f, 0, 0}, 0.125},
                                                  {{0.125f, 2, 0}, 0.125 + 2 * slope},
                                                  {{0.125f, 2, 0.0625f}, 0.0625},
                                                  {{-0.125f, -2, 0}, -0.125 - 2 * slope},
                                                  {{-0.125f, -2, -0.0625f}, -0.0625},
                                                  {{-0.125f, -2, 0.0625f}, -0.125 - 2 * slope}};
    for (const auto& [bias, expected] : cases) EXPECT_NEAR(shift(bias, function), expected, 1e-12);
  }
}

// A draw whose depths are moved into half of the interval, or turned around: its slopes there are halved too, and the
// bias is that of the whole window, halved.
TEST(PlacedSetup, DepthBiasIsThatOfTheWindow) {
  EXPECT_EQ(depth_bias<double>({0, 2, 0, 1}, 0.25, -0.125), 0.5);
  EXPECT_EQ(depth_bias<double>({0, 2, 0, 0.5}, 0.125, -0.0625), 0.25);
  EXPECT_EQ(depth_bias<double>({0.125, 2, 0, -0.5}, 0.125, -0.25), -0.5 * (0.125 + 2 * 0.5));
  EXPECT_EQ(depth_bias<double>({0.125, 2, 0.25, 0.5}, 0.125, 0), 0.125);
}

TEST(PlacedSetup, BiasedDepthsStayInTheWindow) {
  Scene scene = clip_space_scene({{-0.5f, -0.5f, -0.5f}, {0.5f, -0.5f, 0}, {0, 0.5f, 0.5f}}, kWidth, kHeight);
  for (const Compare function : {Compare::less, Compare::greater}) {
    for (const float bias : {-1.0f, -0.3f, 0.3f, 1.0f}) {
      state_of(scene).depth.function = function;
      state_of(scene).depth.bias = {bias, 0, 0};
      const SetupTriangle triangle = scene.setup().triangles.at(0);
      const auto [nearest, farthest] = std::minmax({triangle.vertex_z[0], triangle.vertex_z[1], triangle.vertex_z[2]});
      const bool goes_away = (bias > 0) == (function == Compare::less);
      EXPECT_NEAR(goes_away ? farthest : nearest, goes_away ? 0 : -1, 1e-6) << bias;
      EXPECT_NEAR(farthest - nearest, 0.5, 1e-6) << bias;
    }
  }
}

// At equal depth, cutouts win as opaque draws do; what is blended does not.
TEST(PlacedSetup, CutoutsWinAndTranslucentDrawsDoNot) {
  Scene scene = clip_space_scene({{0, 0, 0}, {0.5f, 0, 0}, {0, 0.5f, 0}});
  scene.frame.draws.assign(3, scene.frame.draws[0]);
  for (Draw& draw : scene.frame.draws) draw.state.depth.function = Compare::less_equal;
  scene.trace.materials.resize(2);
  for (Material& material : scene.trace.materials) material.double_sided = true;
  scene.trace.materials[0].alpha_mode = AlphaMode::mask;
  scene.trace.materials[1].alpha_mode = AlphaMode::blend;
  scene.frame.draws[1].material = 0;
  scene.frame.draws[2].material = 1;
  EXPECT_EQ(scene.setup().draws, (std::vector<std::uint32_t>{1, 0, 2}));
}

// Where two draws are equally near, the later one wins if its depth function says so.
TEST(PlacedSetup, WinnersComeFirst) {
  Scene scene = clip_space_scene({{0, 0, 0}, {0.5f, 0, 0}, {0, 0.5f, 0}, {0, 0, 0}, {0.5f, 0, 0}, {0, 0.25f, 0}});
  scene.frame.draws.assign(5, scene.frame.draws[0]);
  using enum Compare;
  const Compare functions[] = {less, less_equal, less, less_equal, less};
  for (std::size_t i = 0; i < 5; ++i) scene.frame.draws[i].state.depth.function = functions[i];
  const SetupTriangles out = scene.setup();
  EXPECT_EQ(out.draws, (std::vector<std::uint32_t>{3, 3, 1, 1, 0, 0, 2, 2, 4, 4}));
  EXPECT_EQ(out.triangles[0].y[0] + out.triangles[0].y[1] + out.triangles[0].y[2],
            out.triangles[5].y[0] + out.triangles[5].y[1] + out.triangles[5].y[2]);
}

TEST(PlacedSetup, StateOfOtherDrawsChangesNoBit) {
  Random random(336);
  Scene scene = clip_space_scene(random_positions(random, 200, 2), kWidth, kHeight), other = scene;
  other.frame.draws.push_back(other.frame.draws[0]);
  other.frame.draws[1].state.scissor = Scissor{0, 0, 0, 0};  // draws nothing
  StageCounters counters, other_counters;
  expect_same(vertex_setup_of(scene, counters), vertex_setup_of(other, other_counters));
  EXPECT_EQ(counters, other_counters);
}

}  // namespace beampipe::placed_setup_test
