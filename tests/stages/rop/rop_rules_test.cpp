// What draws do, from their state.
#include "stages/rop/rop_rules.h"

#include "tests/test.h"

namespace beampipe::rop_rules_test {

struct Draws {
  Trace trace;
  Frame frame;

  Draws() { trace.meshes.emplace_back().triangles = {{0, 1, 2}}; }
  DrawState& add() { return frame.draws.emplace_back().state; }
  RopRules rules() const { return {trace, frame, glm::vec3(0.25f, 0.5f, 0.75f)}; }
  RopRule first() const { return rules().draws[0][0]; }
};

TEST(RopRules, OfDrawsWithoutState) {
  Draws draws;
  draws.add();
  const RopRules rules = draws.rules();
  EXPECT_EQ(rules.draws[0][0], RopRule{});
  EXPECT_TRUE(rules.draws[0][0].writes_color());
  EXPECT_TRUE(rules.draws[0][0].tests());
  EXPECT_FALSE(rules.draws[0][0].writes_stencil());
  EXPECT_EQ(rules.clear_color, glm::vec4(0.25f, 0.5f, 0.75f, 1));
  EXPECT_TRUE(rules.clears.empty());
  EXPECT_EQ(rules.clear_depth, 0.0f);
}

TEST(RopRules, ADepthTestThatIsOffNeitherTestsNorWrites) {
  Draws draws;
  draws.add().depth = {.test = false, .write = true, .function = Compare::greater};
  EXPECT_EQ(draws.first().depth, Compare::always);
  EXPECT_FALSE(draws.first().writes_depth);
  EXPECT_FALSE(draws.first().tests());
}

TEST(RopRules, WhatReplacesIsNotBlended) {
  Draws draws;
  draws.add().blend = Blend{{BlendFactor::one, BlendFactor::zero}, {}, {}};
  EXPECT_FALSE(draws.first().blend);
  draws.frame.draws[0].state.blend->alpha = BlendEquation{BlendFactor::zero, BlendFactor::one};
  EXPECT_TRUE(draws.first().blend);
}

TEST(RopRules, WhichDrawsWriteColor) {
  Draws draws;
  DrawState& state = draws.add();
  const auto writes = [&] { return draws.first().writes_color(); };
  state.color_mask = kAlphaChannel;
  EXPECT_TRUE(writes());
  state.color_mask = 0;
  EXPECT_FALSE(writes());
  state.color_mask = kRedChannel;
  EXPECT_TRUE(writes());
  state.blend = Blend{{BlendFactor::zero, BlendFactor::one}, {}, {}};
  EXPECT_FALSE(writes());
  state.blend->alpha = BlendEquation{BlendFactor::one, BlendFactor::one};
  EXPECT_FALSE(writes()) << "alpha is masked";
  state.color_mask = kAllChannels;
  EXPECT_TRUE(writes());
}

TEST(RopRules, StencilsOfBothFaces) {
  Draws draws;
  DrawState& state = draws.add();
  state.stencil = Stencil{.reference = 1};
  SetupTriangle triangle{};
  const auto reference = [&](bool front) {
    triangle.front = front;
    return draws.first().stencil_of(triangle).reference;
  };
  EXPECT_EQ(reference(false), 1u) << "that of front faces";
  state.stencil_back = Stencil{.reference = 2};
  EXPECT_EQ(reference(true), 1u);
  EXPECT_EQ(reference(false), 2u);
  state.front_is_clockwise = true;
  EXPECT_EQ(reference(false), 1u);
  EXPECT_FALSE(draws.first().writes_stencil());
  state.stencil_back->depth_fail = StencilOperation::invert;
  EXPECT_TRUE(draws.first().writes_stencil());
  state.stencil_back->write_mask = 0;
  EXPECT_FALSE(draws.first().writes_stencil());
}

TEST(RopRules, BlendedMaterialsGoOverWhatIsStored) {
  Draws draws;
  draws.add();
  const RopRule rule = draws.rules().draws[0][1];
  EXPECT_FALSE(rule.writes_depth);
  ASSERT_TRUE(rule.blend);
  EXPECT_EQ(rule.blend->color, BlendEquation{});
  EXPECT_EQ(rule.blend->alpha->source, BlendFactor::one);
  EXPECT_EQ(rule.blend->alpha->destination, BlendFactor::one_minus_source_alpha);
  draws.frame.draws[0].state.blend = Blend{{BlendFactor::one, BlendFactor::one}, {}, {}};
  EXPECT_EQ(draws.rules().draws[0][1], draws.rules().draws[0][0]) << "the draw's own function comes first";
}

TEST(RopRules, TrianglesHaveTheRuleOfTheirMaterial) {
  Draws draws;
  draws.add(), draws.add().color_mask = kRedChannel;
  SetupTriangles triangles;
  triangles.draws = {0, 1, 0};
  const RopRules rules = draws.rules();
  EXPECT_EQ(&rules.of(triangles, 1), &rules.draws[1][0]);
  triangles.surfaces.resize(3);
  triangles.surfaces[2].is_blended = true;
  EXPECT_EQ(&rules.of(triangles, 0), &rules.draws[0][0]);
  EXPECT_EQ(&rules.of(triangles, 2), &rules.draws[0][1]);
}

TEST(RopRules, ClearsComeBeforeTheirDraws) {
  Draws draws;
  draws.add(), draws.add().depth.cleared_before = true;
  draws.add().stencil_cleared_to = 3;
  draws.add();
  const RopRules rules = draws.rules();
  ASSERT_EQ(rules.clears.size(), 2u);
  std::size_t at = 0;
  std::vector<std::uint32_t> cleared;
  const auto clear = [&](const RopClear& what) { cleared.push_back(what.draw); };
  rules.clear_before(0, at, clear);
  EXPECT_TRUE(cleared.empty());
  rules.clear_before(1, at, clear);
  EXPECT_EQ(cleared, std::vector<std::uint32_t>{1});
  rules.clear_before(1, at, clear);
  rules.clear_before(3, at, clear);
  EXPECT_EQ(cleared, (std::vector<std::uint32_t>{1, 2}));
  EXPECT_TRUE(rules.clears[0].depth);
  EXPECT_EQ(rules.clears[1].stencil, 3u);
}

TEST(RopRules, DepthIsClearedToWhatMostTrianglesPass) {
  Draws draws;
  draws.add().depth.function = Compare::less_equal;
  draws.add().depth = {.write = false, .function = Compare::greater};
  draws.add().depth = {.write = false, .function = Compare::greater};
  EXPECT_EQ(window_clear_depth(draws.trace, draws.frame), 1.0f) << "only what writes counts";
  draws.frame.draws[1].state.depth.write = draws.frame.draws[2].state.depth.write = true;
  EXPECT_EQ(window_clear_depth(draws.trace, draws.frame), 0.0f);
  EXPECT_EQ(draws.rules().clear_depth, -1.0f);
  draws.frame.capture.pictures.depth = {0.5f};
  draws.frame.capture.pictures.clear_depth = 0.75f;
  EXPECT_EQ(window_clear_depth(draws.trace, draws.frame), 0.75f) << "captured";
}

TEST(RopRules, ColorsAreLimitedWhereAllDrawsHavePrograms) {
  Draws draws;
  draws.add(), draws.add();
  draws.frame.draws[0].program.emplace();
  EXPECT_FALSE(draws.rules().limits_color);
  draws.frame.draws[1].program.emplace();
  EXPECT_TRUE(draws.rules().limits_color);
  draws.frame.target = ColorTarget::floats;
  EXPECT_FALSE(draws.rules().limits_color);
}

}  // namespace beampipe::rop_rules_test
