// Compares motion vectors with closed forms.
#include "stages/temporal/motion.h"

#include <glm/gtc/matrix_transform.hpp>

#include "tests/test.h"

namespace beampipe::motion_test {

constexpr std::int32_t kSize = 16;
constexpr Tile kTile{0, 0, kSize, kSize};
constexpr double kHalf = 0x1p-11;  // relative error of an fp16 number

// Orthographic: world x, y in pixels (y up), z in -1..1.
Frame flat_frame(const glm::dmat4& transform) {
  Frame frame;
  frame.width = frame.height = kSize;
  frame.projection = glm::ortho<double>(0, kSize, 0, kSize, -1, 1);
  frame.draws.emplace_back();
  frame.draws[0].transform = transform;
  return frame;
}

// The near plane is 1 in front of the camera, the far plane 100.
Frame perspective_frame() {
  Frame frame;
  frame.width = frame.height = kSize;
  frame.projection = glm::perspectiveRH_NO(1.0, 1.0, 1.0, 100.0);
  frame.draws.emplace_back();
  return frame;
}

// Every pixel shows triangle 0 of draw 0 at one depth.
SampleTile full_surface(float depth, const Sampling& sampling = {CellGrid{}, standard_pattern(1)}) {
  SampleTile surface(kTile, sampling, 0);
  std::fill(surface.depth.begin(), surface.depth.end(), depth);
  std::fill(surface.triangle.begin(), surface.triangle.end(), 0u);
  return surface;
}

std::vector<glm::vec2> vectors(const SampleTile& surface, const Frame& now, const Frame& before) {
  StageCounters counters;
  return motion(surface, {kTile, now, {0}, to_last_frame(poses_of(now), poses_of(before))}, counters);
}

const glm::dmat4 kIdentity(1.0);

// before(i, at): where the point was that pixel i shows at `at` now; both in pixels from the frame's middle, y up.
template <class Before>
void expect_moved(const std::vector<glm::vec2>& found, Before&& before) {
  ASSERT_EQ(found.size(), kTile.pixels());
  for (std::size_t i = 0; i < found.size(); ++i) {
    const double x = static_cast<double>(i % kSize) + 0.5 - kSize / 2,
                 y = kSize / 2 - static_cast<double>(i / kSize) - 0.5;
    const glm::dvec2 was = before(i, glm::dvec2(x, y));
    EXPECT_NEAR(found[i].x, was.x - x, kHalf * kSize) << i;
    EXPECT_NEAR(found[i].y, y - was.y, kHalf * kSize) << i;  // y is down
  }
}

TEST(Motion, WhatStandsStillDoesNotMove) {
  const Frame frame = flat_frame(glm::rotate(kIdentity, 0.3, glm::dvec3(0, 0, 1)));
  for (const glm::vec2& v : vectors(full_surface(-0.5f), frame, frame)) EXPECT_EQ(v, glm::vec2(0));
}

TEST(Motion, PointsBackAlongADrawsTranslation) {
  const Frame before = flat_frame(kIdentity), now = flat_frame(glm::translate(kIdentity, glm::dvec3(2.5, 1, 0)));
  for (const glm::vec2& v : vectors(full_surface(-0.5f), now, before)) EXPECT_EQ(v, glm::vec2(-2.5, 1));  // y is down
}

TEST(Motion, PointsBackAlongADrawsRotation) {
  // A quarter turn, counter-clockwise, about the centre of the frame: (x, y) was at (y, -x), with y up.
  const glm::dvec3 middle(kSize / 2, kSize / 2, 0);
  const glm::dmat4 turn = glm::translate(kIdentity, middle) * glm::rotate(kIdentity, std::acos(0.0), {0, 0, 1}) *
                          glm::translate(kIdentity, -middle);
  expect_moved(vectors(full_surface(-0.5f), flat_frame(turn), flat_frame(kIdentity)),
               [](std::size_t, const glm::dvec2& now) { return glm::dvec2(now.y, -now.x); });
}

TEST(Motion, FollowsTheCameraByDepth) {
  // The camera moves forward by 2. A surface that is now 10 in front of it was 12 in front of it, and 10/12 as far from
  // the centre of the picture. The background, at the far plane, is 100 in front of it and was 102.
  const Frame now = perspective_frame();
  Frame before = now;
  before.view = glm::translate(kIdentity, glm::dvec3(0, 0, -2));
  const glm::dvec4 clip = now.projection * glm::dvec4(0, 0, -10, 1);
  SampleTile surface = full_surface(static_cast<float>((clip.z / clip.w - 1) / 2));
  surface.triangle[3] = kNoTriangle, surface.depth[3] = kFarDepth;
  expect_moved(vectors(surface, now, before),
               [](std::size_t i, const glm::dvec2& at) { return at * (i == 3 ? 100.0 / 102 : 10.0 / 12); });
  // The camera moves backward by 20: the surface was behind the eye.
  before.view = glm::translate(kIdentity, glm::dvec3(0, 0, 20));
  EXPECT_EQ(vectors(surface, now, before)[0].x, std::numeric_limits<float>::infinity());
}

// A draw of one triangle, whose vertices are those of mesh 1 now and were those of mesh 0.
struct Deformed {
  Trace trace;
  Frame now, before;

  Deformed(const Frame& frame, const std::vector<glm::vec3>& moved, const std::vector<glm::vec3>& at)
      : now(frame), before(frame) {
    trace.meshes.resize(2);
    trace.meshes[0].positions = moved, trace.meshes[1].positions = at;
    for (Mesh& mesh : trace.meshes) mesh.triangles = {{0, 1, 2}}, mesh.colors = {glm::vec3(1)};
    now.draws[0].mesh = 1;
  }

  std::vector<glm::vec2> vectors(const SampleTile& surface, StageCounters& counters) const {
    const std::vector<std::uint32_t> numbers = {0}, draws = {0};
    const Poses to = poses_of(now), from = poses_of(before);
    const Deformations deformed = deformations(trace, to, from, numbers);
    return motion(surface, {kTile, now, draws, to_last_frame(to, from), &deformed}, counters);
  }
  std::vector<glm::vec2> vectors() const {
    StageCounters ignored;
    return vectors(full_surface(-0.5f), ignored);
  }
};

TEST(Motion, FollowsVerticesThatAllMoveAlike) {
  const std::vector<glm::vec3> before = {{1, 1, 0}, {9, 2, 0}, {3, 8, 0}};
  std::vector<glm::vec3> now = before;
  for (glm::vec3& at : now) at += glm::vec3(2.5, 1, 0);
  for (const glm::vec2& v : Deformed(flat_frame(kIdentity), before, now).vectors()) {
    EXPECT_NEAR(v.x, -2.5, kHalf * 2.5);
    EXPECT_NEAR(v.y, 1, kHalf);  // y is down
  }
}

TEST(Motion, FollowsATriangleThatGrows) {
  // Twice as large about the lower left corner of the frame: a point at (x, y), y up, was at half of both.
  const std::vector<glm::vec3> before = {{0, 0, 0}, {8, 0, 0}, {0, 8, 0}}, now = {{0, 0, 0}, {16, 0, 0}, {0, 16, 0}};
  const double middle = kSize / 2;
  expect_moved(Deformed(flat_frame(kIdentity), before, now).vectors(),
               [&](std::size_t, const glm::dvec2& at) { return (at + middle) / 2.0 - middle; });
}

TEST(Motion, FollowsVerticesInPerspective) {
  // A triangle that is parallel to the picture comes from 12 to 10 in front of the camera, as in
  // FollowsTheCameraByDepth.
  const std::vector<glm::vec3> before = {{-3, -3, -12}, {5, -2, -12}, {0, 4, -12}},
                               now = {{-3, -3, -10}, {5, -2, -10}, {0, 4, -10}};
  expect_moved(Deformed(perspective_frame(), before, now).vectors(),
               [](std::size_t, const glm::dvec2& at) { return at * (10.0 / 12); });
  std::vector<glm::vec3> behind = before;
  for (glm::vec3& at : behind) at.z = 12;
  EXPECT_EQ(Deformed(perspective_frame(), behind, now).vectors()[0].x, std::numeric_limits<float>::infinity());
}

TEST(Motion, FollowsVerticesAndTheTransformOfTheirDraw) {
  const std::vector<glm::vec3> before = {{1, 1, 0}, {9, 2, 0}, {3, 8, 0}};
  std::vector<glm::vec3> now = before;
  for (glm::vec3& at : now) at.y += 1;
  Deformed moved(flat_frame(kIdentity), before, now);
  moved.now.draws[0].transform = glm::translate(kIdentity, glm::dvec3(3, 0, 0));
  for (const glm::vec2& v : moved.vectors()) {
    EXPECT_NEAR(v.x, -3, kHalf * 4);
    EXPECT_NEAR(v.y, 1, kHalf * 4);
  }
}

TEST(Motion, OtherTrianglesAreNotFollowed) {
  const std::vector<glm::vec3> before = {{1, 1, 0}, {9, 2, 0}, {3, 8, 0}}, now = {{2, 1, 0}, {10, 2, 0}, {4, 8, 0}};
  Deformed turned(flat_frame(kIdentity), before, now);
  turned.trace.meshes[0].triangles = {{0, 2, 1}};
  EXPECT_EQ(turned.vectors()[0], glm::vec2(0));
  Deformed more(flat_frame(kIdentity), before, now);
  more.trace.meshes[0].positions.emplace_back(0);
  EXPECT_EQ(more.vectors()[0], glm::vec2(0));
  EXPECT_TRUE(meshes_before(more.trace, poses_of(more.now), poses_of(more.before)).empty());
}

TEST(Motion, DeformedDrawsAreCharged) {
  const std::vector<glm::vec3> before = {{1, 1, 0}, {9, 2, 0}, {3, 8, 0}}, now = {{2, 1, 0}, {10, 2, 0}, {4, 8, 0}};
  const Deformed moved(flat_frame(kIdentity), before, now);
  SampleTile surface = full_surface(-0.5f);
  surface.triangle[0] = kNoTriangle;
  StageCounters counters, still;
  moved.vectors(surface, counters);
  Deformed rigid = moved;
  rigid.now.draws[0].mesh = 0;
  rigid.vectors(surface, still);
  const std::uint64_t pixels = kSize * kSize - 1;
  EXPECT_EQ(counters.bytes_read - still.bytes_read, pixels * (3 * 4 + 6 * 12));
  // Three indices and six vertices are fetched; three rows of a matrix for each vertex.
  EXPECT_EQ(counters.ops.fetch - still.ops.fetch, pixels * 9);
  EXPECT_EQ(counters.ops.convert, still.ops.convert);
  // Quotients: the pixel's coordinates, one over the determinant and one over w.
  EXPECT_EQ(counters.ops.special - still.ops.special, pixels * 4);
}

std::vector<glm::vec2> placed_vectors(const SampleTile& surface, const Frame& now, const Frame& before,
                                      const DrawPlacement& placement) {
  StageCounters counters;
  return motion(surface, {kTile, now, {0}, to_last_frame(poses_of(now, {placement}), poses_of(before, {placement}))},
                counters);
}

TEST(Motion, FollowsTheViewport) {
  const Frame before = flat_frame(kIdentity), now = flat_frame(glm::translate(kIdentity, glm::dvec3(2.5, 1, 0)));
  // Half the frame's size, upside down.
  const DrawPlacement placement{.x_scale = 0.5, .x_offset = 0.25, .y_scale = -0.5, .y_offset = -0.125};
  for (const glm::vec2& v : placed_vectors(full_surface(-0.5f), now, before, placement))
    EXPECT_EQ(v, glm::vec2(-1.25, -0.5));
}

// As FollowsTheCameraByDepth, with depths that the draw's state puts somewhere else.
TEST(Motion, FollowsPlacedDepths) {
  const Frame now = perspective_frame();
  Frame before = now;
  before.view = glm::translate(kIdentity, glm::dvec3(0, 0, -2));
  const glm::dvec4 clip = now.projection * glm::dvec4(0, 0, -10, 1);
  const double depth = (clip.z / clip.w - 1) / 2;
  for (const DrawPlacement& placement :
       {DrawPlacement{.depth_scale = 0.5, .depth_offset = -0.25}, DrawPlacement{.depth_scale = -1, .depth_offset = -1},
        DrawPlacement{.depth_scale = 0.375, .depth_offset = -1.5},
        DrawPlacement{.depth_scale = 0.375, .depth_offset = 0.9375}}) {
    const auto placed = static_cast<float>(placement.depth_scale * depth + placement.depth_offset);
    expect_moved(placed_vectors(full_surface(placed), now, before, placement),
                 [](std::size_t, const glm::dvec2& at) { return at * (10.0 / 12); });
  }
  // Painted behind: at the far plane. In front: at the near plane, 1 in front of the camera, and 3 before.
  for (const bool in_front : {false, true}) {
    const DrawPlacement painted{.depth_scale = 0, .depth_offset = in_front ? -1.5 : 0.5, .layer_step = 0.25};
    expect_moved(placed_vectors(full_surface(in_front ? -1.5f : 0.5f), now, before, painted),
                 [&](std::size_t, const glm::dvec2& at) { return at * (in_front ? 1.0 / 3 : 100.0 / 102); });
  }
}

// A draw moves by 3 pixels and the camera by 4, at right angles: the surface by 5, and the camera alone by 4.
TEST(Motion, CameraSpeedsLeaveOutDraws) {
  const Frame before = flat_frame(kIdentity);
  Frame now = flat_frame(glm::translate(kIdentity, glm::dvec3(3, 0, 0)));
  now.view = glm::translate(kIdentity, glm::dvec3(0, 4, 0));
  const SampleTile surface = full_surface(-0.5f);
  StageCounters counters;
  EXPECT_NEAR(glm::length(vectors(surface, now, before)[0]), 5, kHalf * 5);
  for (const float speed :
       camera_speeds(surface, {kTile, now, {0}, to_last_frame(poses_of(now), poses_of(before))}, counters))
    EXPECT_NEAR(speed, 4, kHalf * 4);
  // Per pixel: the movement of a point, two numbers to float and fp16, two products, a sum and a root to fp16.
  EXPECT_EQ(counters.bytes_written, std::uint64_t{kSize} * kSize * 2);
  EXPECT_EQ(counters.ops.convert, std::uint64_t{kSize} * kSize * 5);
}

TEST(Motion, FollowsTheNearestSample) {
  const Frame before = flat_frame(kIdentity), now = flat_frame(glm::translate(kIdentity, glm::dvec3(1, 0, 0)));
  SampleTile surface(kTile, {CellGrid{}, standard_pattern(8)}, 0);  // background
  surface.depth[5] = -0.25f, surface.triangle[5] = 0;               // sample 5 of the first pixel
  const std::vector<glm::vec2> found = vectors(surface, now, before);
  EXPECT_EQ(found[0], glm::vec2(-1, 0));
  EXPECT_EQ(found[1], glm::vec2(0, 0));
}

PixelContents contents_of(const SampleTile& surface, const Frame& now, const Frame& before) {
  StageCounters counters;
  const std::vector<std::uint32_t> draws = {0, 1};
  return contents(surface, {kTile, now, draws, to_last_frame(poses_of(now), poses_of(before))}, looks_of(now),
                  counters);
}

TEST(Motion, ContentsAreThoseOfAllSamples) {
  Frame before = flat_frame(kIdentity), now = flat_frame(glm::translate(kIdentity, glm::dvec3(3, 4, 0)));
  before.draws.emplace_back(), now.draws.emplace_back();
  now.draws[0].mesh = before.draws[0].mesh = 1;
  SampleTile surface = full_surface(-0.5f, {CellGrid{}, standard_pattern(8)});  // draw 0, which moves by 5
  std::fill_n(surface.triangle.begin() + 8, 8, 1u);                             // pixel 1: draw 1, which stands still
  std::fill_n(surface.triangle.begin() + 16, 7, 1u);                            // pixel 2: both
  std::fill_n(surface.triangle.begin() + 24, 2, 1u);                            // pixel 3: both, and the background
  surface.triangle[31] = kNoTriangle, surface.depth[31] = kFarDepth;
  const PixelContents found = contents_of(surface, now, before);
  EXPECT_EQ(std::vector<float>(found.speeds.begin(), found.speeds.begin() + 4), (std::vector<float>{5, 0, 5, 5}));
  const std::vector<std::uint32_t> looks = looks_of(now);
  EXPECT_EQ(found.looks[0], looks[0]);
  EXPECT_EQ(found.looks[1], looks[1]);
  EXPECT_EQ(found.looks[2], looks[0] ^ looks[1]);
  EXPECT_EQ(found.looks[3], looks[0] ^ looks[1] ^ looks[2]);
}

TEST(Motion, ALookIsOfAllThatColorsAreMadeFrom) {
  Frame frame = flat_frame(kIdentity);
  frame.draws.resize(2);
  const std::vector<std::uint32_t> before = looks_of(frame);
  const auto changed = [&](const auto& change) {
    Frame after = frame;
    change(after);
    const std::vector<std::uint32_t> looks = looks_of(after);
    std::vector<bool> result;
    for (std::size_t i = 0; i < looks.size(); ++i) result.push_back(looks[i] != before[i]);
    return result;
  };
  using Which = std::vector<bool>;
  EXPECT_NE(before[0], before[1]) << "the index of the draw";
  EXPECT_EQ(changed([](Frame& f) { f.draws[0].mesh = 1; }), (Which{true, false, false}));
  EXPECT_EQ(changed([](Frame& f) { f.draws[1].kd = glm::vec3(0, 0, 1); }), (Which{false, true, false}));
  EXPECT_EQ(changed([](Frame& f) { f.background = glm::vec3(1, 0, 0); }), (Which{false, false, true}));
  EXPECT_EQ(changed([](Frame& f) { f.draws[0].transform[3][0] = 1; }), (Which{false, false, false}));
  EXPECT_EQ(changed([](Frame& f) { f.lighting.lights = {{glm::vec3(1, 0, 0)}}; }), (Which{false, false, false}))
      << "unlit";
  const glm::dmat4 turn = glm::rotate(kIdentity, 0.05, glm::dvec3(0, 1, 0));
  EXPECT_EQ(changed([&](Frame& f) { f.draws[1].transform = turn; }), (Which{false, false, false})) << "unlit";
  frame.draws[0].shading = Shading::lambert;
  EXPECT_EQ(changed([](Frame&) {}), (Which{true, false, false}));
  const std::uint32_t lit = looks_of(frame)[0];
  frame.draws[0].transform[3][0] = 1;
  EXPECT_EQ(looks_of(frame)[0], lit) << "the position has no influence";
  frame.draws[0].transform = turn;
  EXPECT_NE(looks_of(frame)[0], lit) << "the orientation has";
}

TEST(Motion, DrawsAreKnownByIndexAndMesh) {
  const Frame before = flat_frame(kIdentity);
  Frame now = flat_frame(glm::translate(kIdentity, glm::dvec3(1, 0, 0)));
  now.draws[0].mesh = 1;
  EXPECT_EQ(vectors(full_surface(-0.5f), now, before)[0], glm::vec2(0));
  Frame without = before;
  without.draws.clear();
  now.draws[0].mesh = 0;
  EXPECT_EQ(vectors(full_surface(-0.5f), now, without)[0], glm::vec2(0));
  EXPECT_EQ(vectors(full_surface(-0.5f), now, before)[0], glm::vec2(-1, 0));
}

// TemporalTwins count operations.
TEST(Motion, CountsWhatItReadsAndWrites) {
  const Frame frame = flat_frame(kIdentity);
  const SampleTile surface = full_surface(-0.5f, {CellGrid{}, standard_pattern(8)});
  const std::vector<std::uint32_t> draws = {0};
  const std::vector<glm::dmat4> to_last = to_last_frame(poses_of(frame), poses_of(frame));
  const MovingTile in{kTile, frame, draws, to_last};
  constexpr std::uint64_t kPixels = kSize * kSize;
  StageCounters counters, without_ids, of_contents;
  motion(surface, in, counters);
  EXPECT_EQ(counters.bytes_read, kPixels * (8 * 4 + 4));
  EXPECT_EQ(counters.bytes_written, kPixels * 4);
  EXPECT_EQ(counters.items_in, kPixels * 8);
  EXPECT_EQ(counters.items_out, kPixels);
  EXPECT_EQ(counters.lanes_used, kPixels);
  EXPECT_EQ(counters.lanes_issued, kPixels);
  // Without ids, neither the draw nor its matrix is fetched.
  motion(surface, in, without_ids, MotionFrom::depth);
  OperationCounts fetched = without_ids.ops;
  fetched.fetch += 2 * kPixels;
  EXPECT_EQ(fetched, counters.ops);
  EXPECT_EQ(without_ids.bytes_read, kPixels * 8 * 4);
  contents(surface, in, looks_of(frame), of_contents);
  EXPECT_EQ(of_contents.bytes_read, kPixels * 8 * 4);
  EXPECT_EQ(of_contents.bytes_written, kPixels * (4 + 2));
}

}  // namespace beampipe::motion_test
