// The check of captured depths, on traces whose captured depth is known.
#include "tools/evaluate/captured_check.h"

#include "tests/test.h"
#include "tools/evaluate/captured_colors.h"
#include "tools/evaluate/draw_notes.h"
#include "traces/files/trace_io.h"

namespace beampipe::captured_check_test {

constexpr std::uint32_t kSize = 8;

// A quad of whole pixels at one window depth, for a frame without camera.
void add_quad(Trace& trace, glm::ivec2 from, glm::ivec2 to, float depth, const DepthState& state = {}) {
  const auto corner = [&](int x, int y) {
    return glm::vec3(2.0f * static_cast<float>(x) / kSize - 1, 1 - 2.0f * static_cast<float>(y) / kSize, 2 * depth - 1);
  };
  Mesh mesh;
  mesh.positions = {corner(from.x, from.y), corner(to.x, from.y), corner(to.x, to.y), corner(from.x, to.y)};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh.colors.assign(2, glm::vec3(1));
  Draw& draw = trace.frames[0].draws.emplace_back();
  draw.mesh = static_cast<std::uint32_t>(trace.meshes.size());
  draw.state.depth = state;
  trace.meshes.push_back(mesh);
}

Trace empty_trace() {
  Trace trace;
  Frame& frame = trace.frames.emplace_back();
  frame.width = frame.height = kSize;
  frame.capture.pictures.depth.assign(kSize * kSize, 1.0f);
  return trace;
}

CapturedCheck check(const Trace& trace) {
  return check_captured(trace.frames[0], sampled_depths(trace, trace.frames[0], nullptr));
}

TEST(CapturedCheck, FindsWindowDepthsAndDraws) {
  Trace trace = empty_trace();
  add_quad(trace, {0, 0}, {4, 4}, 0.5f);
  add_quad(trace, {2, 2}, {8, 8}, 0.25f, {.function = Compare::less_equal, .near = 0.5f, .far = 1.0f});
  DepthState untested;
  untested.test = false;
  add_quad(trace, {0, 0}, {8, 8}, 0.125f, untested);  // writes no depth
  const SampledDepths found = sampled_depths(trace, trace.frames[0], nullptr);
  for (std::uint32_t y = 0; y < kSize; ++y)
    for (std::uint32_t x = 0; x < kSize; ++x) {
      const std::size_t pixel = y * kSize + x;
      const bool first = x < 4 && y < 4, second = x >= 2 && y >= 2;
      EXPECT_EQ(found.draw[pixel], first ? 0u : second ? 1u : kNoDraw) << x << ", " << y;
      if (!first && !second) continue;
      EXPECT_NEAR(found.depth[pixel], first ? 0.5 : 0.625, 1e-12);
    }
}

TEST(CapturedCheck, ReversedDepthIsWindowDepthToo) {
  Trace trace = empty_trace();
  trace.frames[0].capture.pictures.clear_depth = 0;
  add_quad(trace, {0, 0}, {8, 8}, 0.25f, {.function = Compare::greater});
  add_quad(trace, {0, 0}, {4, 8}, 0.75f, {.function = Compare::greater});
  const SampledDepths found = sampled_depths(trace, trace.frames[0], nullptr);
  EXPECT_NEAR(found.depth[0], 0.75, 1e-12);
  EXPECT_NEAR(found.depth[kSize - 1], 0.25, 1e-12);
}

// Of four samples the first is 6/16 px from the left and 2/16 px from the top.
TEST(CapturedCheck, LooksAtTheFirstSample) {
  Trace trace = empty_trace();
  trace.frames[0].capture.pictures.samples = 4;
  add_quad(trace, {0, 0}, {8, 8}, 0.5f);
  std::vector<glm::vec3>& corners = trace.meshes[0].positions;
  corners[1].z = corners[2].z = 0.5f;  // window depth 0.5 at the left and 0.75 at the right
  EXPECT_NEAR(sampled_depths(trace, trace.frames[0], nullptr).depth[0], 0.5 + 0.25 * 0.375 / kSize, 1e-9);
}

// A pixel's shader runs at its centre, whatever the places of its samples: alpha grows by 1/8 per pixel, and the cutout
// begins between the first sample of pixel 4 and its centre.
TEST(CapturedCheck, CutoutsAreTestedAtTheCentre) {
  Trace trace = empty_trace();
  trace.frames[0].capture.pictures.samples = 4;
  add_quad(trace, {0, 0}, {8, 8}, 0.5f);
  trace.meshes[0].vertex_colors = {{1, 1, 1, 0}, {1, 1, 1, 1}, {1, 1, 1, 1}, {1, 1, 1, 0}};
  Material& cutout = trace.materials.emplace_back();
  cutout.alpha_mode = AlphaMode::mask, cutout.alpha_cutoff = 4.4375f / kSize;
  trace.frames[0].draws[0].material = 0;
  const TextureSet textures(trace);
  const SampledDepths found = sampled_depths(trace, trace.frames[0], &textures);
  EXPECT_EQ(found.draw[3], kNoDraw);
  EXPECT_EQ(found.draw[4], 0u);
}

// Only what is drawn after the last clear is in the program's depth buffer at the end.
TEST(CapturedCheck, ClearsForgetEarlierDepths) {
  Trace trace = empty_trace();
  add_quad(trace, {0, 0}, {8, 8}, 0.5f);
  add_quad(trace, {0, 0}, {4, 8}, 0.75f, {.cleared_before = true});
  const SampledDepths found = sampled_depths(trace, trace.frames[0], nullptr);
  EXPECT_EQ(found.draw[0], 1u);
  EXPECT_NEAR(found.depth[0], 0.75, 1e-12);
  EXPECT_EQ(found.draw[kSize - 1], kNoDraw);
}

TEST(CapturedCheck, DepthCountsWhateverHappensToColors) {
  Trace trace = empty_trace();
  add_quad(trace, {0, 0}, {4, 8}, 0.5f);
  add_quad(trace, {4, 0}, {8, 8}, 0.25f);
  std::vector<Draw>& draws = trace.frames[0].draws;
  draws[0].state.color_mask = 0;
  draws[1].state.blend = Blend{{BlendFactor::source_alpha, BlendFactor::one}};
  trace.materials.emplace_back().alpha_mode = AlphaMode::blend;
  draws[1].material = 0;
  const SampledDepths found = sampled_depths(trace, trace.frames[0], nullptr);
  EXPECT_EQ(found.draw[0], 0u);
  EXPECT_NEAR(found.depth[0], 0.5, 1e-12);
  EXPECT_EQ(found.draw[kSize - 1], 1u);
  EXPECT_NEAR(found.depth[kSize - 1], 0.25, 1e-12);
}

TEST(CapturedCheck, CountsPixelsThatDiffer) {
  Trace trace = empty_trace();
  add_quad(trace, {0, 0}, {8, 4}, 0.5f);
  add_quad(trace, {0, 4}, {8, 6}, 0.25f);
  std::vector<float>& depth = trace.frames[0].capture.pictures.depth;
  for (std::size_t i = 0; i < 48; ++i) depth[i] = i < 32 ? 0.5f : 0.25f;
  EXPECT_EQ(check(trace).coverage(), 1.0);
  EXPECT_EQ(check(trace).equal_part(), 1.0);
  EXPECT_TRUE(check(trace).draws.empty());
  depth[0] = 0.5f + 0.5e-4f;                    // close
  depth[1] = 0.6f;                              // not close
  depth[40] = depth[41] = 0.5f, depth[42] = 1;  // the second draw's: two that differ, one not there
  depth[63] = depth[62] = 0.9f;                 // only there
  const CapturedCheck found = check(trace);
  EXPECT_EQ(found.here, 48u);
  EXPECT_EQ(found.there, 49u);
  EXPECT_EQ(found.both, 47u);
  EXPECT_EQ(found.coverage(), 47.0 / 50);
  EXPECT_EQ(found.close, 44u);
  EXPECT_EQ(found.equal, 43u);
  EXPECT_EQ(found.largest, 0.25);
  ASSERT_EQ(found.draws.size(), 3u);
  EXPECT_EQ(found.draws[0].draw, 1u);
  EXPECT_EQ(found.draws[0].differing, 3u);
  EXPECT_EQ(found.draws[0].pixels, 16u);
  EXPECT_EQ(found.draws[1].draw, kNoDraw);
  EXPECT_EQ(found.draws[1].differing, 2u);
  EXPECT_EQ(found.draws[2].draw, 0u);
  EXPECT_EQ(found.draws[2].differing, 1u);
  const std::vector<std::uint8_t> picture =
      difference_picture(trace.frames[0], sampled_depths(trace, trace.frames[0], nullptr));
  ASSERT_EQ(picture.size(), 3 * 64u);
  EXPECT_NE(picture[0], picture[3]);
}

// A program of six draws, with instances, a depth bias, a scissor and draws without depth test.
TEST(CapturedCheck, AgreesWithTheCapturedSample) {
  const Trace trace = read_trace(std::filesystem::path(BEAMPIPE_SOURCE_FOLDER) / "traces/samples/captured_quads.json");
  const TextureSet textures(trace);
  const SampledDepths depths = sampled_depths(trace, trace.frames[0], &textures);
  const CapturedCheck found = check_captured(trace.frames[0], depths);
  EXPECT_GT(found.there, 3000u);
  EXPECT_GE(found.coverage(), 0.999);
  EXPECT_GE(found.close_part(), 0.999);
  const Image image = parse_technique("msaa:1").render(trace, 0).image;
  EXPECT_GE(check_colors(trace, trace.frames[0], image, depths.draw).close_part(), 0.999);
}

TEST(CapturedCheck, NeedsACapturedDepth) {
  Trace trace = empty_trace();
  trace.frames[0].capture.pictures.depth.clear();
  EXPECT_THROW(check(trace), std::invalid_argument);
}

TEST(DrawNotes, AreOneLineEach) {
  EXPECT_EQ(text_of(DrawNote{"stencil test", true, 12, 340}), "12 draws (340 triangles) are left out: stencil test");
  EXPECT_EQ(text_of(DrawNote{"stencil test", true, 1, 1}), "1 draw (1 triangle) is left out: stencil test");
  EXPECT_EQ(text_of(DrawNote{"depth function not_equal", false, 2, 4}),
            "2 draws (4 triangles) are drawn in the nearest way: depth function not_equal");
}

TEST(DrawNotes, OfSeveralFramesAreAddedUp) {
  Trace trace = empty_trace();
  add_quad(trace, {0, 0}, {8, 8}, 0.5f);
  trace.frames[0].draws[0].state.stencil = Stencil{.function = Compare::equal};
  trace.frames.push_back(trace.frames[0]);
  EXPECT_EQ(notes_of(trace, {0, 1}, ProgramSet(trace), "casav"),
            (std::vector<DrawNote>{{"stencil test (casav)", true, 2, 4}}));
  EXPECT_EQ(notes_of(trace, {1}, ProgramSet(trace), "casav"),
            (std::vector<DrawNote>{{"stencil test (casav)", true, 1, 2}}));
  EXPECT_TRUE(notes_of(trace, {0, 1}, ProgramSet(trace), "").empty());
}

}  // namespace beampipe::captured_check_test
