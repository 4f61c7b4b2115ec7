// Digests: the check value of the XZ format's CRC-64; and whatever changes the picture of a trace changes its digest.
#include "tools/files/digest.h"

#include "tests/pipeline/test_traces.h"
#include "tests/test.h"

namespace beampipe::digest_test {

TEST(Digest, IsTheCrcOfTheXzFormat) { EXPECT_EQ(digest_of("123456789"), "995dc9bbdf1939fa"); }

TEST(Digest, TellsStateApart) {
  std::set<std::string> seen;
  const auto expect_new = [&](const std::function<void(Frame&, DrawState&)>& change) {
    Trace trace = pixel_trace(4, 4, {{{{0, 0, 0.5}, {4, 0, 0.5}, {0, 4, 0.5}}, glm::vec3(1)}});
    change(trace.frames[0], trace.frames[0].draws[0].state);
    EXPECT_TRUE(seen.insert(digest_of(trace)).second) << "change number " << seen.size();
  };
  expect_new([](Frame&, DrawState&) {});
  expect_new([](Frame& frame, DrawState&) { frame.target = ColorTarget::unorm; });
  expect_new([](Frame& frame, DrawState&) { frame.target = ColorTarget::floats; });
  expect_new([](Frame& frame, DrawState&) { frame.background_alpha = 0; });
  expect_new([](Frame& frame, DrawState&) { frame.capture.pictures.depth.assign(16, 1.0f); });
  expect_new([](Frame& frame, DrawState&) {
    frame.capture.pictures.depth.assign(16, 1.0f), frame.capture.pictures.clear_depth = 0;
  });
  expect_new([](Frame& frame, DrawState&) { frame.capture.pictures.color = 0, frame.capture.pictures.samples = 4; });
  expect_new([](Frame&, DrawState& state) { state.viewport = Viewport{0, 0, 4, 4}; });
  expect_new([](Frame&, DrawState& state) { state.scissor = Scissor{0, 0, 4, 4}; });
  expect_new([](Frame&, DrawState& state) { state.depth.function = Compare::equal; });
  expect_new([](Frame&, DrawState& state) { state.depth.cleared_before = true; });
  expect_new([](Frame&, DrawState& state) { state.front_is_clockwise = true; });
  expect_new([](Frame&, DrawState& state) { state.blend = Blend{}; });
  expect_new([](Frame&, DrawState& state) { state.blend = Blend{{}, BlendEquation{}, {}}; });
  expect_new([](Frame&, DrawState& state) { state.color_mask = 7; });
  expect_new([](Frame&, DrawState& state) { state.alpha_to_coverage = true; });
  expect_new([](Frame&, DrawState& state) { state.stencil = Stencil{}; });
  expect_new([](Frame&, DrawState& state) { state.stencil_back = Stencil{}; });
  expect_new([](Frame&, DrawState& state) { state.stencil = state.stencil_back = Stencil{}; });
  expect_new([](Frame&, DrawState& state) { state.stencil_back = Stencil{.function = Compare::never}; });
  expect_new([](Frame&, DrawState& state) { state.stencil_cleared_to = 0; });
  expect_new([](Frame&, DrawState& state) { state.stencil_cleared_to = 1; });
}

}  // namespace beampipe::digest_test
