// What plan_draws makes of state: which draws are left out, and which depths the others have.
#include "stages/geometry/draw_plan.h"

#include "tests/simd/random.h"
#include "tests/stages/vertex_scenes.h"

namespace beampipe::draw_plan_test {

// Frames of draws of one triangle each, each with a mesh of its own.
struct Draws {
  Trace trace;
  Frame frame;

  Draws() { frame.width = frame.height = 16; }

  Draw& add(std::size_t triangles = 1) {
    const float x = static_cast<float>(trace.meshes.size());
    Mesh mesh;
    mesh.positions = {{x, 0, 0}, {x + 1, 0, 0}, {x, 1, 0}};
    mesh.triangles.assign(triangles, {0, 1, 2});
    mesh.colors.assign(triangles, glm::vec3(1));
    frame.draws.emplace_back().mesh = static_cast<std::uint32_t>(trace.meshes.size());
    trace.meshes.push_back(mesh);
    return frame.draws.back();
  }
  Draw& add(Compare function) {
    Draw& draw = add();
    draw.state.depth.function = function;
    return draw;
  }
  Draw& add_untested(std::size_t triangles = 1) {
    Draw& draw = add(triangles);
    draw.state.depth.test = false;
    return draw;
  }
  DrawPlan plan() const { return plan_draws(trace, frame); }
  std::vector<DrawNote> notes() const { return plan().notes; }
};

// The depths between which a draw's triangles lie.
struct Range {
  double near, far;
};
Range range_of(const DrawPlacement& placement, std::size_t triangles = 1) {
  if (placement.layer_step > 0)
    return {placement.depth_offset - placement.layer_step * static_cast<double>(triangles - 1), placement.depth_offset};
  const double a = placement.depth_offset, b = placement.depth_offset - placement.depth_scale;
  return {std::min(a, b), std::max(a, b)};
}

TEST(DrawPlan, DrawsWithoutStateNeedNone) {
  Draws draws;
  draws.add(), draws.add();
  EXPECT_TRUE(draws.plan().placements.empty());
  EXPECT_TRUE(draws.notes().empty());
}

TEST(DrawPlan, StateThatSaysWhatHoldsAnywayChangesNothing) {
  Draws draws;
  Draw& draw = draws.add();
  draw.state.viewport = Viewport{0, 0, 16, 16};
  draw.state.scissor = Scissor{-3, 0, 40, 16};
  draw.state.stencil = Stencil{};
  draw.state.blend = Blend{{BlendFactor::one, BlendFactor::zero}};
  const DrawPlan plan = draws.plan();
  ASSERT_EQ(plan.placements.size(), 1u);
  EXPECT_EQ(plan.placements[0], DrawPlacement{});
  EXPECT_TRUE(plan.notes.empty());
}

TEST(DrawPlan, SkiesLieBehindAndDisplaysInFront) {
  Draws draws;
  draws.add_untested(3), draws.add_untested();
  draws.frame.draws[0].mesh = 0;
  draws.add(Compare::less), draws.add(Compare::less);
  draws.add_untested(2), draws.add_untested();
  const DrawPlan plan = draws.plan();
  EXPECT_TRUE(plan.notes.empty());
  const std::vector<DrawPlacement>& p = plan.placements;
  const Range sky = range_of(p[0], 3), sky2 = range_of(p[1]), world = range_of(p[2]), display = range_of(p[4], 2),
              display2 = range_of(p[5]);
  EXPECT_EQ(world.near, -1);
  EXPECT_EQ(world.far, 0);
  EXPECT_EQ(p[2], p[3]);
  EXPECT_LT(sky.far, 1);
  EXPECT_LT(sky2.far, sky.near);
  EXPECT_LT(world.far, sky2.near);
  EXPECT_LT(display.far, world.near);
  EXPECT_LT(display2.far, display.near);
  EXPECT_LT(-2, display2.near);
}

// A sky may also test depth, before anything has written it.
TEST(DrawPlan, WhatWritesNoDepthBeforeAnythingElseIsPaintedBehind) {
  Draws draws;
  draws.add(Compare::less).state.depth.write = false;
  draws.add(Compare::less);
  const DrawPlan plan = draws.plan();
  EXPECT_GT(range_of(plan.placements[0]).near, range_of(plan.placements[1]).far);
  EXPECT_TRUE(plan.notes.empty());
}

// The usual form of a pre-pass: what is drawn after it compares with equal and writes no depth.
TEST(DrawPlan, ColorsAfterAPrePassKeepTheirDepths) {
  for (const Compare function : {Compare::equal, Compare::less_equal}) {
    Draws draws;
    draws.add(Compare::less).state.color_mask = 0;
    draws.add(Compare::less).state.color_mask = 0;
    for (std::uint32_t mesh = 0; mesh < 2; ++mesh) {
      Draw& draw = draws.frame.draws.emplace_back();
      draw.mesh = mesh;
      draw.state.depth.function = function;
      draw.state.depth.write = false;
    }
    draws.add(Compare::less);
    const DrawPlan plan = draws.plan();
    EXPECT_TRUE(plan.notes.empty());
    EXPECT_FALSE(plan.placements[0].is_drawn);
    for (const std::size_t i : {2u, 3u, 4u}) {
      EXPECT_EQ(range_of(plan.placements[i]).near, -1) << i;
      EXPECT_EQ(range_of(plan.placements[i]).far, 0) << i;
    }
  }
}

TEST(DrawPlan, NotesWhatIsTranslucentBeforeOpaqueDraws) {
  Draws draws;
  draws.trace.materials.resize(1);
  draws.trace.materials[0].alpha_mode = AlphaMode::blend;
  draws.add(Compare::less);
  Draw& sheet = draws.add(Compare::less);
  sheet.material = 0;
  sheet.state.depth.write = false;
  EXPECT_TRUE(draws.notes().empty());
  draws.add(Compare::less);
  ASSERT_EQ(draws.notes().size(), 1u);
  EXPECT_EQ(draws.notes()[0].reason, "translucent, before opaque draws");
  // The same of the mesh, and then with a colour in its place, which is opaque.
  draws.trace.meshes[1].materials = {0};
  draws.frame.draws[1].material.reset();
  ASSERT_EQ(draws.notes().size(), 1u);
  EXPECT_EQ(draws.notes()[0].reason, "translucent, before opaque draws");
  draws.frame.draws[1].kd = glm::vec3(1);
  ASSERT_EQ(draws.notes().size(), 1u);
  EXPECT_EQ(draws.notes()[0].reason, "depth is tested but not written");
}

TEST(DrawPlan, EachDepthClearStartsAGroupInFront) {
  Draws draws;
  for (int group = 0; group < 5; ++group) {
    draws.add(Compare::less).state.depth.cleared_before = true;
    draws.add(Compare::less_equal);
    draws.add_untested();
  }
  const DrawPlan plan = draws.plan();
  EXPECT_TRUE(plan.notes.empty());
  double nearest = 2;
  for (std::size_t i = 0; i < plan.placements.size(); i += 3) {
    const Range tested = range_of(plan.placements[i]), also = range_of(plan.placements[i + 1]),
                display = range_of(plan.placements[i + 2]);
    EXPECT_EQ(tested.near, also.near);
    EXPECT_LT(tested.far, nearest) << i;
    EXPECT_LT(display.far, tested.near);
    nearest = display.near;
  }
  EXPECT_GT(nearest, -2);
}

// The group with most tested triangles keeps its depths; of several, the first.
TEST(DrawPlan, TheLargestGroupKeepsItsDepths) {
  const auto scales = [](std::initializer_list<std::size_t> triangles) {
    Draws draws;
    for (const std::size_t count : triangles) draws.add(count).state.depth.cleared_before = true;
    std::vector<double> found;
    for (const DrawPlacement& placement : draws.plan().placements) found.push_back(placement.depth_scale);
    return found;
  };
  const std::vector<double> second = scales({1, 3, 2}), first = scales({2, 2, 2});
  EXPECT_EQ(second.at(1), 1);
  EXPECT_LT(std::max(second.at(0), second.at(2)), 1);
  EXPECT_EQ(first.at(0), 1);
  EXPECT_LT(std::max(first.at(1), first.at(2)), 1);
}

// Random frames: each triangle of a later part lies in front of all of earlier parts, in floats too.
TEST(DrawPlan, RandomGroupsAreInOrder) {
  Random random(311);
  for (int round = 0; round < 300; ++round) {
    Draws draws;
    const std::int64_t groups = random.integer(1, 9);
    std::vector<std::pair<std::size_t, std::size_t>> parts;  // draws [first, end) of each part
    const auto part = [&](std::size_t first) {
      if (draws.frame.draws.size() > first) parts.emplace_back(first, draws.frame.draws.size());
    };
    for (std::int64_t g = 0; g < groups; ++g) {
      const std::size_t skies = draws.frame.draws.size();
      for (std::int64_t i = random.integer(0, 3); i-- > 0;)
        draws.add_untested(static_cast<std::size_t>(random.integer(1, 500))),
            parts.emplace_back(draws.frame.draws.size() - 1, draws.frame.draws.size());
      const std::size_t world = draws.frame.draws.size();
      draws.add(static_cast<std::size_t>(random.integer(1, 20)));
      draws.add(Compare::less_equal);
      part(world);
      if (random.one_in(2)) {
        draws.add_untested(static_cast<std::size_t>(random.integer(1, 500)));
        parts.emplace_back(draws.frame.draws.size() - 1, draws.frame.draws.size());
      }
      draws.frame.draws[skies].state.depth.cleared_before = true;
    }
    const DrawPlan plan = draws.plan();
    ASSERT_TRUE(plan.notes.empty());
    float nearest = 1.0f;
    int kept = 0;
    for (const auto& [first, end] : parts) {
      float next = nearest;
      for (std::size_t i = first; i < end; ++i) {
        const std::size_t triangles = draws.trace.meshes[draws.frame.draws[i].mesh].triangles.size();
        const DrawPlacement& placement = plan.placements[i];
        const Range range = range_of(placement, triangles);
        ASSERT_LT(static_cast<float>(range.far), nearest) << "round " << round << ", draw " << i;
        next = std::min(next, static_cast<float>(range.near));
        if (placement.layer_step > 0)
          for (std::size_t t = 1; t < triangles; ++t) {
            const auto depth = [&](std::size_t at) {
              return static_cast<float>(placement.depth_offset - placement.layer_step * static_cast<double>(at));
            };
            ASSERT_LT(depth(t), depth(t - 1));
          }
        kept += placement.layer_step == 0 && range.near == -1 && range.far == 0;
      }
      nearest = next;
    }
    EXPECT_GT(nearest, -2.0f);
    EXPECT_EQ(kept, 2) << "the draws of one group keep their depths";
  }
}

TEST(DrawPlan, DepthRangesBecomeWindowDepthMinusOne) {
  Draws draws;
  draws.add(Compare::less).state.depth.near = 0.25f;
  draws.frame.draws[0].state.depth.far = 0.75f;
  const Range range = range_of(draws.plan().placements[0]);
  EXPECT_EQ(range.near, -0.75);
  EXPECT_EQ(range.far, -0.25);
}

TEST(DrawPlan, GreaterReversesDepth) {
  Draws draws;
  draws.add(Compare::greater).state.depth.near = 0.25f;
  draws.add(Compare::greater_equal);
  const DrawPlan plan = draws.plan();
  EXPECT_TRUE(plan.notes.empty());
  EXPECT_EQ(plan.placements[0].depth_offset, -1);    // far plane, window depth 1
  EXPECT_EQ(plan.placements[0].depth_scale, -0.75);  // near plane: -0.25
  EXPECT_FALSE(plan.placements[0].last_wins);
  EXPECT_TRUE(plan.placements[1].last_wins);
  draws.add(Compare::less);
  EXPECT_EQ(draws.notes(), (std::vector<DrawNote>{{"depth functions less and greater are mixed", false, 1, 1}}));
}

// As many triangles compare one way as the other.
TEST(DrawPlan, DepthIsNotReversedOnATie) {
  Draws draws;
  draws.add(Compare::greater), draws.add(Compare::less);
  const DrawPlan plan = draws.plan();
  for (const DrawPlacement& placement : plan.placements) EXPECT_GT(placement.window_scale, 0);
  EXPECT_EQ(plan.notes, (std::vector<DrawNote>{{"depth functions less and greater are mixed", false, 1, 1}}));
}

// As many triangles test depth before it as after it.
TEST(DrawPlan, UntestedDrawsInTheMiddleLieInFront) {
  Draws draws;
  draws.add(), draws.add_untested(), draws.add();
  const DrawPlan plan = draws.plan();
  for (const std::size_t tested : {0u, 2u})
    EXPECT_LT(range_of(plan.placements[1]).far, range_of(plan.placements[tested]).near) << tested;
}

// The pre-pass is dropped, and equal says nothing about which way is near.
TEST(DrawPlan, APrePassSaysWhichWayIsNear) {
  Draws draws;
  draws.add(Compare::greater).state.color_mask = 0;
  draws.add(Compare::equal).mesh = 0;
  const DrawPlan plan = draws.plan();
  EXPECT_TRUE(plan.notes.empty());
  EXPECT_LT(plan.placements[1].depth_scale, 0);
}

TEST(DrawPlan, NotesWhatDepthsCannotExpress) {
  Draws draws;
  draws.add(Compare::less);
  draws.add_untested(7);
  draws.add(Compare::less);
  draws.add(Compare::not_equal);
  draws.add(Compare::equal);
  draws.add(Compare::always);
  draws.add(Compare::less).state.depth.write = false;
  draws.add(Compare::less);
  const std::vector<DrawNote> expected = {
      {"no depth test, between draws that have one", false, 1, 7},
      {"depth function not_equal", false, 1, 1},
      {"depth function equal, without an earlier draw of the same triangles", false, 1, 1},
      {"depth function always, with depth writes", false, 1, 1},
      {"depth is tested but not written", false, 1, 1}};
  EXPECT_EQ(draws.notes(), expected);
}

// Which pixels a cutout leaves is known only when it is drawn; translucent triangles let others show.
TEST(DrawPlan, OnlyOpaqueTrianglesWriteDepthsThatOthersRepeat) {
  for (const AlphaMode mode : {AlphaMode::opaque, AlphaMode::mask, AlphaMode::blend}) {
    Draws draws;
    draws.trace.materials.resize(1);
    draws.trace.materials[0].alpha_mode = mode;
    draws.add(Compare::less).material = 0;
    Draw again = draws.frame.draws[0];
    again.state.depth.function = Compare::equal;
    draws.frame.draws.push_back(again);
    const DrawNote note{"depth function equal, without an earlier draw of the same triangles", false, 1, 1};
    EXPECT_EQ(std::ranges::count(draws.notes(), note), mode == AlphaMode::opaque ? 0 : 1);
  }
}

TEST(DrawPlan, WhatPassesAtEqualDepthHidesEarlierDraws) {
  using enum Compare;
  const std::pair<Compare, bool> cases[] = {{never, false},        {less, false},    {equal, true},
                                            {less_equal, true},    {greater, false}, {not_equal, false},
                                            {greater_equal, true}, {always, true}};
  for (const auto& [function, passes] : cases) {
    Draws draws;
    draws.add(less).state.depth.near = 0.25f;  // so that depths are placed
    draws.add(function);
    draws.add(less);
    EXPECT_EQ(draws.plan().placements[1].last_wins, passes) << static_cast<int>(function);
  }
}

TEST(DrawPlan, NeverDrawsNothing) {
  Draws draws;
  draws.add(Compare::never);
  EXPECT_FALSE(draws.plan().placements[0].is_drawn);
  EXPECT_TRUE(draws.notes().empty());
}

TEST(DrawPlan, LeavesOutStencilTests) {
  Draws draws;
  draws.add().state.stencil = Stencil{.function = Compare::equal};
  draws.add(4).state.stencil = Stencil{.function = Compare::never};
  Draw& mark = draws.add();
  mark.state.stencil = Stencil{.pass = StencilOperation::replace};
  mark.state.color_mask = 0, mark.state.depth.write = false;
  Draw& both = draws.add();
  both.state.stencil = Stencil{.pass = StencilOperation::increment};
  const DrawPlan plan = draws.plan();
  EXPECT_EQ(plan.notes, (std::vector<DrawNote>{{"stencil test", true, 2, 5}, {"stencil without colour", true, 1, 1}}));
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(plan.placements[i].is_drawn, i == 3) << i;
}

// Each of the three operations changes the stencil values that later draws find.
TEST(DrawPlan, NotesEveryStencilOperationOfDrawsWithoutColor) {
  Draws draws;
  for (const Stencil& stencil :
       {Stencil{.fail = StencilOperation::replace}, Stencil{.depth_fail = StencilOperation::replace},
        Stencil{.pass = StencilOperation::replace}, Stencil{}}) {
    DrawState& state = draws.add().state;
    state.stencil = stencil;
    state.color_mask = 0, state.depth.write = false;
  }
  EXPECT_EQ(draws.notes(), (std::vector<DrawNote>{{"stencil without colour", true, 3, 3}}));
}

TEST(DrawPlan, LeavesOutOtherBlendFunctions) {
  Draws draws;
  draws.trace.materials.emplace_back().alpha_mode = AlphaMode::blend;
  using enum BlendFactor;
  const auto add = [&](bool translucent, const Blend& blend) {
    Draw& draw = draws.add();
    if (translucent) draw.material = 0;
    draw.state.blend = blend;
  };
  add(true, {});
  add(true, {one, zero});
  add(true, {one, one_minus_source_alpha});
  add(false, {one, one_minus_source_alpha});  // opaque: the same as no blending
  add(false, {one, one});
  add(true, {source_alpha, one});
  add(false, {zero, one});  // changes nothing
  add(false, {source_alpha, zero});
  const DrawPlan plan = draws.plan();
  const bool drawn[] = {true, true, false, true, false, false, false, true};
  for (std::size_t i = 0; i < std::size(drawn); ++i) EXPECT_EQ(plan.placements[i].is_drawn, drawn[i]) << i;
  EXPECT_FALSE(plan.placements[0].is_opaque);
  EXPECT_TRUE(plan.placements[1].is_opaque);
  EXPECT_EQ(plan.notes, (std::vector<DrawNote>{{"blending of premultiplied colours", true, 1, 1},
                                               {"a blend function other than alpha blending", true, 2, 2},
                                               {"depth without colour", true, 1, 1},
                                               {"translucent, before opaque draws", false, 1, 1}}));
}

TEST(DrawPlan, APrePassIsDroppedWhereItsTrianglesAreDrawnAgain) {
  Draws draws;
  draws.add().state.color_mask = 0;
  draws.add(3).state.color_mask = kAlphaChannel;
  Draw& again = draws.add(Compare::equal);
  again.mesh = 0;
  const DrawPlan plan = draws.plan();
  EXPECT_EQ(plan.notes, (std::vector<DrawNote>{{"depth without colour", true, 1, 3}}));
  EXPECT_FALSE(plan.placements[0].is_drawn);
  EXPECT_TRUE(plan.placements[2].is_drawn);
  draws.frame.draws[2].state.depth.cleared_before = true;  // the pre-pass counts no more
  EXPECT_EQ(draws.notes()[0].draws, 2u);
}

TEST(DrawPlan, EmptyRectanglesDrawNothing) {
  Draws draws;
  draws.add().state.scissor = Scissor{4, 4, 0, 8};
  draws.add().state.scissor = Scissor{4, 4, 8, 0};
  draws.add().state.scissor = Scissor{16, 0, 8, 8};
  Draw& both = draws.add();
  both.state.viewport = Viewport{0, 0, 8, 16}, both.state.scissor = Scissor{8, 0, 8, 16};
  const DrawPlan plan = draws.plan();
  for (const DrawPlacement& placement : plan.placements) EXPECT_FALSE(placement.is_drawn);
  EXPECT_TRUE(plan.notes.empty());
}

// In 1/256 px. The scissor lies within the viewport on two sides and outside it on the others.
TEST(DrawPlan, DrawsStayWithinTheViewportAndTheScissor) {
  Draws draws;
  draws.add().state.viewport = Viewport{2, 12, 8, -6};  // upside down
  Draw& both = draws.add();
  both.state.viewport = Viewport{4, 4, 8, 8}, both.state.scissor = Scissor{2, 6, 7, 10};
  Draw& other = draws.add();
  other.state.viewport = Viewport{4, 4, 8, 8}, other.state.scissor = Scissor{6, 2, 10, 7};
  const DrawPlan plan = draws.plan();
  const std::array<std::int32_t, 4> expected[] = {{2, 6, 10, 12}, {4, 6, 9, 12}, {6, 4, 12, 9}};
  for (std::size_t i = 0; i < std::size(expected); ++i) {
    const DrawPlacement& placement = plan.placements[i];
    const std::array<std::int32_t, 4> sides = {placement.left / 256, placement.top / 256, placement.right / 256,
                                               placement.bottom / 256};
    EXPECT_EQ(sides, expected[i]) << i;
  }
}

// ---- The API's order ----

TEST(DrawPlan, InTheApisOrderDepthsAreWindowDepths) {
  Draws draws;
  DrawState& state = draws.add(Compare::greater).state;
  state.depth.near = 0.25f, state.depth.far = 0.75f;
  state.depth.bias = {.constant = 0.125f, .slope = 2, .clamp = 0.5f};
  state.stencil = Stencil{.function = Compare::never};
  state.color_mask = 0;
  const DrawPlan plan = plan_draws(draws.trace, draws.frame, DrawOrder::of_api);
  EXPECT_TRUE(plan.notes.empty());
  ASSERT_EQ(plan.placements.size(), 1u);
  const DrawPlacement& placement = plan.placements[0];
  EXPECT_TRUE(placement.is_drawn);
  // z is -1 at the near plane and 0 at the far one.
  EXPECT_EQ(-placement.depth_scale + placement.depth_offset, 0.25 - 1);
  EXPECT_EQ(placement.depth_offset, 0.75 - 1);
  EXPECT_EQ(placement.window_scale, 1);
  EXPECT_EQ(placement.window_offset, -1);
  EXPECT_EQ(placement.bias_constant, 0.125);
  EXPECT_EQ(placement.bias_slope, 2);
  EXPECT_EQ(placement.bias_clamp, 0.5);
  EXPECT_EQ(placement.layer_step, 0);
  EXPECT_FALSE(placement.last_wins);
}

TEST(DrawPlan, WhichFramesNeedTheApisOrder) {
  const auto needs = [](auto&& change) {
    Draws draws;
    draws.add();
    Draw& draw = draws.add();
    draws.trace.materials.emplace_back().alpha_mode = AlphaMode::blend;
    change(draw);
    return needs_api_order(draws.trace, draws.frame);
  };
  EXPECT_FALSE(needs([](Draw&) {}));
  EXPECT_FALSE(needs([](Draw& draw) { draw.state.depth.function = Compare::less_equal; }));
  EXPECT_FALSE(needs([](Draw& draw) { draw.material = 0; })) << "materials have no order of their own";
  EXPECT_FALSE(needs([](Draw& draw) { draw.state.blend = Blend{}; })) << "opaque";
  EXPECT_TRUE(needs([](Draw& draw) { draw.state.blend = Blend{}, draw.material = 0; }));
  EXPECT_FALSE(needs([](Draw& draw) {
    draw.state.blend = Blend{{BlendFactor::one, BlendFactor::zero}, {}, {}}, draw.material = 0;
  }));
  EXPECT_TRUE(needs([](Draw& draw) { draw.state.stencil = Stencil{.function = Compare::equal}; }));
  EXPECT_TRUE(needs([](Draw& draw) { draw.state.depth.function = Compare::not_equal; }));
  EXPECT_TRUE(needs([](Draw& draw) { draw.state.color_mask = kRedChannel; }));
  EXPECT_TRUE(needs([](Draw& draw) { draw.state.stencil_back = Stencil{.function = Compare::equal}; }));
  EXPECT_TRUE(needs([](Draw& draw) { draw.state.depth.write = false; })) << "its triangles may overlap";
  EXPECT_TRUE(needs([](Draw& draw) { draw.state.depth.function = Compare::greater, draw.state.depth.write = false; }));
}

// A first draw of one triangle, at depth 0.5 unless said otherwise.
TEST(DrawPlan, WhichSingleDrawsNeedTheApisOrder) {
  const auto needs = [](auto&& change) {
    Draws draws;
    Draw& draw = draws.add();
    draw.state.depth.cleared_before = true;
    change(draw, draws.trace.meshes[0].positions);
    return needs_api_order(draws.trace, draws.frame);
  };
  using Places = std::vector<glm::vec3>;
  const auto put = [](Places& places, float z) {
    for (glm::vec3& place : places) place.z = z;  // -1 at the near plane, 1 at the far plane
  };
  EXPECT_FALSE(needs([](Draw&, Places&) {}));
  EXPECT_TRUE(needs([](Draw& draw, Places&) { draw.state.depth.function = Compare::always; })) << "later ones hide";
  EXPECT_FALSE(needs([](Draw& draw, Places&) { draw.state.depth.test = false; })) << "painted";
  EXPECT_TRUE(needs([](Draw& draw, Places&) { draw.state.depth.function = Compare::equal; })) << "equal to what?";
  EXPECT_TRUE(needs([&](Draw&, Places& places) { put(places, 1); })) << "is not less than 1";
  EXPECT_FALSE(
      needs([&](Draw& draw, Places& places) { put(places, 1), draw.state.depth.function = Compare::less_equal; }));
  EXPECT_TRUE(needs([&](Draw& draw, Places& places) { put(places, -1), draw.state.depth.function = Compare::greater; }))
      << "is not greater than 0";
  EXPECT_FALSE(
      needs([&](Draw& draw, Places& places) { put(places, -1), draw.state.depth.function = Compare::greater_equal; }));
  EXPECT_FALSE(needs([&](Draw&, Places& places) { put(places, 1), places[0].z = 0; })) << "1 along a line";
  EXPECT_TRUE(needs([&](Draw& draw, Places& places) {
    put(places, 1), places[0].z = 2, places[1].z = 0, draw.state.depth.clip = false;
  })) << "1 where it is beyond";
  EXPECT_TRUE(needs([&](Draw& draw, Places& places) { put(places, 2), draw.state.depth.clip = false; }));
  EXPECT_FALSE(needs([&](Draw& draw, Places& places) { put(places, 2), draw.state.depth.bias.constant = -0.125f; }))
      << "all is clipped";
  EXPECT_TRUE(needs([](Draw& draw, Places&) { draw.state.depth.near = draw.state.depth.far = 1; }));
  EXPECT_TRUE(needs([](Draw& draw, Places&) { draw.state.depth.bias.constant = 0.5f; })) << "0.5 and 0.5 are 1";
  EXPECT_TRUE(needs([](Draw& draw, Places&) {
    draw.state.depth.bias.constant = 0.75f, draw.state.depth.function = Compare::less_equal;
  })) << "0.5 + 0.75 is stored as 1, as are other depths beyond it";
  EXPECT_FALSE(needs([](Draw& draw, Places&) { draw.state.depth.bias.constant = 0.25f; }));
  // Window depth rises from 0.5 to 0.75 over 8 pixels: by 1/32 in each. Eight times that more is 1.
  EXPECT_FALSE(needs([&](Draw& draw, Places& places) { places[1].z = 0.5f, draw.state.depth.bias.slope = 7; }));
  EXPECT_TRUE(needs([&](Draw& draw, Places& places) { places[1].z = 0.5f, draw.state.depth.bias.slope = 9; }));
}

TEST(DrawPlan, TranslucentDrawsThatWinTiesNeedTheApisOrder) {
  for (const Compare function : {Compare::less, Compare::less_equal}) {
    Draws draws;
    draws.add(Compare::less_equal);
    draws.trace.materials.emplace_back().alpha_mode = AlphaMode::blend;
    draws.add(function).material = 0;
    EXPECT_EQ(needs_api_order(draws.trace, draws.frame), function == Compare::less_equal);
    draws.add(Compare::equal).mesh = 1;
    EXPECT_TRUE(needs_api_order(draws.trace, draws.frame)) << "translucent draws write no depth";
  }
}

// Only one part of the frame can keep its depths.
TEST(DrawPlan, DepthsOnBothSidesOfAClearNeedTheApisOrder) {
  Draws draws;
  draws.add(), draws.add_untested();
  draws.frame.draws[1].state.depth.cleared_before = true;
  EXPECT_FALSE(needs_api_order(draws.trace, draws.frame));
  draws.add();
  EXPECT_TRUE(needs_api_order(draws.trace, draws.frame));
  EXPECT_TRUE(draws.notes().empty()) << "the order is right";
}

TEST(DrawPlan, APrePassOfOtherDepthsNeedsTheApisOrder) {
  const auto needs = [](auto&& change) {
    Draws draws;
    draws.add().state.color_mask = 0;
    draws.add(Compare::equal).mesh = 0;
    draws.trace.materials.emplace_back().alpha_mode = AlphaMode::mask;
    change(draws.frame.draws[0], draws.frame.draws[1]);
    return needs_api_order(draws.trace, draws.frame);
  };
  EXPECT_FALSE(needs([](Draw&, Draw&) {}));
  EXPECT_TRUE(needs([](Draw&, Draw& second) { second.state.scissor = Scissor{0, 0, 8, 8}; }));
  EXPECT_TRUE(needs([](Draw& first, Draw&) { first.material = 0; }));
  EXPECT_TRUE(needs([](Draw& first, Draw&) { first.state.depth.function = Compare::always; }));
  EXPECT_TRUE(needs([](Draw&, Draw& second) { second.cull = Cull::back; }));
  EXPECT_TRUE(needs([](Draw& first, Draw& second) {
    first.cull = second.cull = Cull::back, second.state.front_is_clockwise = true;
  }));
  EXPECT_TRUE(needs([](Draw&, Draw& second) { second.material = 0; }));
}

}  // namespace beampipe::draw_plan_test
