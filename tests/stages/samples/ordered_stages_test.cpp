// Tests and blending of samples in the API's order, by hand.
#include "stages/data/sample_tile.h"
#include "stages/samples/ordered_blend.h"
#include "stages/samples/ordered_test.h"
#include "tests/stages/screen_triangles.h"
#include "tests/test.h"

namespace beampipe::ordered_stages_test {

constexpr Tile kTile{0, 0, 2, 1};
const Sampling kTwo{CellGrid{}, standard_pattern(2)};

// One draw a triangle, each over the whole tile at a depth of its own. Fragments are those of pixel (1, 0).
struct Draws {
  Trace trace;
  Frame frame;
  SetupTriangles triangles;
  std::vector<SampleFragment> fragments;

  Draws() { trace.meshes.emplace_back().triangles = {{0, 1, 2}}; }

  DrawState& add(float depth, std::uint32_t mask = 3) {
    add_triangle(triangles, everywhere(depth));
    const auto number = static_cast<std::uint32_t>(triangles.draws.size());
    triangles.draws.push_back(number);
    fragments.push_back({number, number, 1, 0, mask});
    return frame.draws.emplace_back().state;
  }

  RopRules rules() const { return {trace, frame, glm::vec3(0.5f)}; }
};

struct Tested {
  OrderedTile surface;
  std::vector<SampleFragment> left;
  std::vector<OrderedAccess> accesses = {};
  StageCounters counters = {};

  // `fragments`: of the draws.
  explicit Tested(const Draws& draws)
      : surface(kTile, 2, 0.0f, true, glm::vec4(0.5f, 0.5f, 0.5f, 1)), left(draws.fragments) {
    ordered_test({draws.triangles, kTile, kTwo}, draws.rules(), counters, surface, left, accesses);
  }
};

TEST(OrderedTest, TestsAndWritesDrawByDraw) {
  Draws draws;
  draws.add(-0.5f);
  draws.add(-0.25f);                                       // behind
  draws.add(-0.25f, 1).depth.function = Compare::greater;  // in front of nothing, but greater
  draws.add(-0.75f, 2).depth.write = false;
  const Tested found(draws);
  ASSERT_EQ(found.left.size(), 3u);
  EXPECT_EQ(found.left[0].mask, 3u);
  EXPECT_EQ(found.left[1].triangle, 2u);
  EXPECT_EQ(found.left[2].triangle, 3u);
  EXPECT_EQ(found.surface.depth, (std::vector<float>{0, 0, -0.25f, -0.5f}));
  // Cell 1: both are read by two draws, and one by each of the others. The last one writes nothing.
  ASSERT_EQ(found.accesses.size(), 4u);
  for (const OrderedAccess& access : found.accesses) EXPECT_EQ(access.cell, 1u);
  EXPECT_EQ(found.accesses[1].read, 3u);
  EXPECT_EQ(found.accesses[1].written, 0u);
  EXPECT_EQ(found.accesses[2].written, 1u);
  EXPECT_EQ(found.accesses[3].written, 0u);
}

TEST(OrderedTest, AFragmentMayHaveADepthOfItsOwn) {
  Draws draws;
  draws.add(-0.5f), draws.add(-0.25f, 1), draws.add(-0.75f, 2);
  draws.fragments[1].depth = -0.625f;  // in front of the first one
  draws.fragments[2].depth = -0.375f;  // behind it
  const Tested found(draws);
  ASSERT_EQ(found.left.size(), 2u);
  EXPECT_EQ(found.left[1].triangle, 1u);
  EXPECT_EQ(found.surface.depth, (std::vector<float>{0, 0, -0.625f, -0.5f}));
}

TEST(OrderedTest, CountsItsWork) {
  Draws draws;
  draws.add(-0.5f), draws.add(-0.25f);
  const Tested found(draws);
  EXPECT_EQ(found.counters.items_in, 4u);
  EXPECT_EQ(found.counters.items_out, 2u);
  EXPECT_EQ(found.counters.bytes_read, 4u * 4 + 2 * kSampleFragmentBytes);
  EXPECT_EQ(found.counters.bytes_written, 2u * 4);
  EXPECT_EQ(found.counters.lanes_used, 4u);
  EXPECT_EQ(found.counters.lanes_issued, 4u);
  // Of a fragment, its plane in the cell: two differences and two sums. Of a sample, two sums and a comparison.
  EXPECT_EQ(found.counters.ops.add, 2u * 4 + 4 * 3);
}

TEST(OrderedTest, WithoutATestNothingIsReadAndNothingKept) {
  Draws draws;
  draws.add(-0.5f).depth.test = false;
  const Tested found(draws);
  EXPECT_TRUE(found.accesses.empty());
  EXPECT_EQ(found.surface.depth[2], 0.0f);
  EXPECT_EQ(found.counters.bytes_read, kSampleFragmentBytes);
  EXPECT_EQ(found.left.size(), 1u);
}

TEST(OrderedTest, StencilFailsDepthFailsAndPasses) {
  Draws draws;
  DrawState& fails = draws.add(-0.5f);
  fails.stencil = Stencil{.function = Compare::equal, .reference = 7, .fail = StencilOperation::increment};
  DrawState& hidden = draws.add(-0.5f, 1);
  hidden.depth.function = Compare::greater;
  hidden.stencil = Stencil{.reference = 5, .depth_fail = StencilOperation::replace};
  DrawState& seen = draws.add(-0.5f, 2);
  seen.stencil = Stencil{.reference = 9, .pass = StencilOperation::replace};
  const Tested found(draws);
  EXPECT_EQ(found.surface.stencil, (std::vector<std::uint8_t>{0, 0, 5, 9}));
  ASSERT_EQ(found.left.size(), 1u);
  EXPECT_EQ(found.left[0].triangle, 2u);
  EXPECT_EQ(found.surface.depth, (std::vector<float>{0, 0, 0, -0.5f}));
  ASSERT_EQ(found.accesses.size(), 3u);
  EXPECT_EQ(found.accesses[0].written, 3u) << "words with both";
}

// Two samples that are compared with an `and` of each side; one of them then keeps its value, which costs nothing.
TEST(OrderedTest, CountsStencils) {
  Draws draws;
  DrawState& state = draws.add(-0.5f);
  state.depth.test = false;
  const OperationCounts without = Tested(draws).counters.ops;
  state.stencil = Stencil{.function = Compare::equal};
  const OperationCounts with = Tested(draws).counters.ops;
  EXPECT_EQ(with.add - without.add, 2u);
  EXPECT_EQ(with.bit - without.bit, 2u);
  state.stencil->pass = StencilOperation::increment;  // a sum, a comparison, two `and` and an `or`
  const OperationCounts more = Tested(draws).counters.ops;
  EXPECT_EQ(more.add - with.add, 2u * 2);
  EXPECT_EQ(more.bit - with.bit, 2u * 3);
}

// What may write a word but has no bit to write leaves it alone.
TEST(OrderedTest, MaskedStencilsWriteNothing) {
  Draws draws;
  DrawState& state = draws.add(-0.5f);
  state.depth.test = false;
  state.stencil = Stencil{.reference = 9, .write_mask = 0, .pass = StencilOperation::replace};
  const Tested found(draws);
  ASSERT_EQ(found.accesses.size(), 1u);
  EXPECT_EQ(found.accesses[0].read, 3u);
  EXPECT_EQ(found.accesses[0].written, 0u);
  EXPECT_EQ(found.counters.bytes_written, 0u);
}

// Both samples fail: nobody computes their depth, or what passes would store. The plane takes two differences and two
// sums.
TEST(OrderedTest, WhatFailsCostsNoMore) {
  Draws draws;
  draws.add(-0.5f).stencil = Stencil{.function = Compare::never, .pass = StencilOperation::increment};
  EXPECT_EQ(Tested(draws).counters.ops.add, 4u);
}

// Two triangles of one draw: only samples of the second one, a back face, are counted up.
TEST(OrderedTest, EachFaceHasItsCosts) {
  Draws draws;
  DrawState& state = draws.add(-0.5f);
  state.depth.test = false;
  add_triangle(draws.triangles, everywhere(-0.5f));
  draws.triangles.draws.push_back(0);
  draws.triangles.triangles[0].front = true, draws.triangles.triangles[1].front = false;
  draws.fragments.push_back({1, 1, 1, 0, 3});
  const OperationCounts without = Tested(draws).counters.ops;
  state.stencil = Stencil{.function = Compare::equal}, state.stencil_back = state.stencil;
  state.stencil_back->pass = StencilOperation::increment;
  const OperationCounts with = Tested(draws).counters.ops;
  EXPECT_EQ(with.add - without.add, 4u + 2 * 2);
  EXPECT_EQ(with.bit - without.bit, 4u + 2 * 3);
}

TEST(OrderedTest, ClearsOfStencilsKeepDepth) {
  Draws draws;
  draws.add(-0.75f), draws.add(-0.5f).stencil_cleared_to = 4;
  const Tested found(draws);
  EXPECT_EQ(found.left.size(), 1u);
  EXPECT_EQ(found.surface.depth[2], -0.75f);
}

TEST(OrderedTest, ClearsComeBeforeTheirDraw) {
  Draws draws;
  draws.add(-0.75f).stencil = Stencil{.reference = 1, .pass = StencilOperation::replace};
  DrawState& second = draws.add(-0.5f, 1);
  second.depth.cleared_before = true;
  second.stencil_cleared_to = 4;
  const Tested found(draws);
  EXPECT_EQ(found.left.size(), 2u);
  EXPECT_EQ(found.surface.depth, (std::vector<float>{0, 0, -0.5f, 0}));
  EXPECT_EQ(found.surface.stencil, (std::vector<std::uint8_t>{4, 4, 4, 4}));
}

TEST(OrderedTest, DrawsWithoutColorEndHere) {
  Draws draws;
  draws.add(-0.5f).color_mask = 0;
  const Tested found(draws);
  EXPECT_TRUE(found.left.empty());
  EXPECT_EQ(found.counters.items_out, 2u);
  EXPECT_EQ(found.surface.depth[2], -0.5f);
}

TEST(OrderedTest, DepthsAreLimited) {
  Draws draws;
  draws.add(-1.5f);
  draws.add(0.5f).depth = {.function = Compare::equal};  // becomes 0, where nothing else is
  draws.fragments[0].mask = 1;
  const Tested found(draws);
  EXPECT_EQ(found.surface.depth, (std::vector<float>{0, 0, -1, 0}));
  ASSERT_EQ(found.left.size(), 2u);
  EXPECT_EQ(found.left[1].mask, 2u);
}

// Two cells in a pixel, left and right. The fragments are in the right one of pixel (1, 0), which is cell 3 of the tile
// and whose samples are numbers 2 and 3 of the pixel.
const Sampling kHalves{CellGrid{2, 1}, standard_pattern(2)};

struct Halves {
  OrderedTile surface{kTile, 4, 0.0f, false, glm::vec4(0.0f)};
  PixelObservers observers{2};
  std::vector<OrderedAccess> accesses;
  StageCounters counters;

  Halves() {
    observers[1] = std::make_unique<PixelObserver>();
    observers[1]->add_positions(std::vector<glm::vec2>(4));
    surface.color_bytes = 8, surface.observers = &observers;
  }
  void test(const Draws& draws, std::vector<SampleFragment> fragments) {
    ordered_test({draws.triangles, kTile, kHalves}, draws.rules(), counters, surface, fragments, accesses);
  }
  const std::vector<HistoryFragment>& seen() const { return observers[1]->history.fragments; }
};

TEST(OrderedTest, CellsHaveTheirPlaceInThePixel) {
  Draws draws;
  add_triangle(draws.triangles, {-1024, -1024, -2}, {2048, -1024, 1}, {-1024, 2048, -2});  // x / 4 - 1, in pixels
  draws.triangles.draws = {0};
  draws.frame.draws.emplace_back();
  Halves found;
  found.test(draws, {{0, 0, 3, 0, 3}});
  for (std::size_t s = 0; s < 2; ++s)
    EXPECT_NEAR(found.surface.depth[6 + s], (1.5 + static_cast<double>(kHalves.pattern.x[s]) / 256) / 4 - 1, 1e-6) << s;
}

TEST(OrderedTest, ObserversSeeWhatFails) {
  Draws draws;
  draws.add(-0.5f), draws.add(-0.25f), draws.add(-0.75f);
  for (SampleFragment& fragment : draws.fragments) fragment.x = 3;
  draws.fragments[2].mask = 1;
  Halves found;
  found.test(draws, draws.fragments);
  ASSERT_EQ(found.seen().size(), 3u);
  EXPECT_EQ(found.seen()[0].mask, std::vector<bool>(4));
  EXPECT_EQ(found.seen()[1].mask, (std::vector<bool>{false, false, true, true})) << "behind";
  EXPECT_EQ(found.seen()[2].mask, std::vector<bool>(4));
}

TEST(OrderedBlend, ObserversSeeWhichSamplesAreBlended) {
  Draws draws;
  draws.add(-0.5f, 2);
  draws.fragments[0].x = 3;
  Halves found;
  ordered_blend({draws.triangles, kTile, kHalves}, draws.rules(), {draws.fragments, {glm::vec4(1)}}, found.counters,
                found.surface, found.accesses);
  ASSERT_EQ(found.seen().size(), 1u);
  EXPECT_EQ(found.seen()[0].mask, (std::vector<bool>{false, false, false, true}));
}

struct Blended {
  OrderedTile surface;
  std::vector<OrderedAccess> accesses = {};
  StageCounters counters = {};

  Blended(const Draws& draws, const std::vector<glm::vec4>& colors, std::uint32_t color_bytes = 8,
          AccumulatorFormat format = AccumulatorFormat::fp32, bool limits = false)
      : surface(kTile, 2, 0.0f, false, glm::vec4(0.5f, 0.5f, 0.5f, 0.25f)) {
    surface.color_bytes = color_bytes;
    surface.format = format;
    RopRules rules = draws.rules();
    rules.limits_color = limits;
    ordered_blend({draws.triangles, kTile, kTwo}, rules, {draws.fragments, colors}, counters, surface, accesses);
  }
};

TEST(OrderedBlend, ReplacesOrBlendsOnlyItsSamples) {
  Draws draws;
  draws.add(0, 1);
  draws.add(0, 2).blend = Blend{{BlendFactor::source_alpha, BlendFactor::one}, {}, {}};
  const Blended found(draws, {{1, 0, 0, 1}, {0.5f, 1, 0, 0.5f}});
  EXPECT_EQ(found.surface.color[0], glm::vec4(0.5f, 0.5f, 0.5f, 0.25f));
  EXPECT_EQ(found.surface.color[2], glm::vec4(1, 0, 0, 1));
  EXPECT_EQ(found.surface.color[3], glm::vec4(0.75f, 1, 0.5f, 0.5f));
  EXPECT_EQ(found.surface.is_drawn, (std::vector<bool>{false, false, true, true}));
  ASSERT_EQ(found.accesses.size(), 2u);
  EXPECT_EQ(found.accesses[0].read, 0u);
  EXPECT_EQ(found.accesses[0].written, 1u);
  EXPECT_EQ(found.accesses[1].read, 2u);
  EXPECT_EQ(found.accesses[1].written, 2u);
}

TEST(OrderedBlend, WritesOnlyTheChannelsOfTheMask) {
  Draws draws;
  draws.add(0).color_mask = kGreenChannel | kAlphaChannel;
  EXPECT_EQ(Blended(draws, {{1, 0, 1, 0}}).surface.color[2], glm::vec4(0.5f, 0, 0.5f, 0));
}

TEST(OrderedBlend, LimitsAndRoundsColors) {
  Draws draws;
  draws.add(0).blend = Blend{{BlendFactor::one, BlendFactor::one}, {}, {}};
  EXPECT_EQ(Blended(draws, {{1, 0, 0, 1}}).surface.color[2].r, 1.5f);
  EXPECT_EQ(Blended(draws, {{1, 0, 0, 1}}, 8, AccumulatorFormat::fp32, true).surface.color[2].r, 1.0f);
  // 0.7 x 255 = 178.5 + 0.3; the nearest code is 179 (0.2 + 0.5 = 0.7).
  EXPECT_EQ(Blended(draws, {{0.2f, 0, 0, 0}}, 4, AccumulatorFormat::unorm8).surface.color[2].r, 179 / 255.0f);
}

// Two samples. Opaque: four conversions each. Blended: four more from the stored format, and a sum for each channel.
TEST(OrderedBlend, CountsItsWork) {
  Draws draws;
  draws.frame.draws.reserve(2);
  DrawState& state = draws.add(0);
  const Blended opaque(draws, {glm::vec4(1)});
  EXPECT_EQ(opaque.counters.ops, (OperationCounts{.convert = 8}));
  EXPECT_EQ(opaque.counters.bytes_read, kSampleFragmentBytes);
  EXPECT_EQ(opaque.counters.bytes_written, 16u);
  EXPECT_EQ(opaque.counters.items_out, 2u);
  EXPECT_EQ(opaque.counters.lanes_issued, 2u);
  state.blend = Blend{{BlendFactor::one, BlendFactor::one}, {}, {}};
  const Blended blended(draws, {glm::vec4(1)});
  EXPECT_EQ(blended.counters.ops, (OperationCounts{.add = 8, .convert = 16}));
  EXPECT_EQ(blended.counters.bytes_read, kSampleFragmentBytes + 16);
  const Blended rgb(draws, {glm::vec4(1)}, kSampleColorBytes);
  EXPECT_EQ(rgb.counters.ops, (OperationCounts{.add = 6, .convert = 12})) << "three channels";
  state.blend.reset(), state.color_mask = kGreenChannel;
  EXPECT_EQ(Blended(draws, {glm::vec4(1)}).counters.ops, (OperationCounts{.convert = 2})) << "one channel";
  draws.add(0).blend = Blend{{BlendFactor::one, BlendFactor::one}, {}, {}};
  EXPECT_EQ(Blended(draws, {glm::vec4(1), glm::vec4(1)}).counters.ops, (OperationCounts{.add = 8, .convert = 2 + 16}));
}

}  // namespace beampipe::ordered_stages_test
