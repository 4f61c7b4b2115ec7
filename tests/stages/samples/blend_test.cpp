// Blending of translucent sample fragments, by hand.
#include "stages/samples/blend.h"

#include "stages/samples/test_depth.h"
#include "tests/stages/surface_scene.h"
#include "tests/test.h"

namespace beampipe::blend_test {

constexpr Tile kTile{0, 0, 4, 4};

// Rectangles over the whole tile: red at half opacity at depth 0.5, blue at a quarter at depth 0.25, and an opaque gray
// one at depth 0.75. Triangle numbers: 0 and 1, 2 and 3, 4 and 5.
SurfaceTrace sheets() {
  SurfaceTrace scene(4, 4);
  scene.add_rectangle(-8, -8, 16, 16, 0.5, unlit_material({1, 0, 0, 0.5f}, AlphaMode::blend));
  scene.add_rectangle(-8, -8, 16, 16, 0.25, unlit_material({0, 0, 1, 0.25f}, AlphaMode::blend));
  scene.add_rectangle(-8, -8, 16, 16, 0.75, unlit_material({0.5f, 0.5f, 0.5f, 1}));
  return scene;
}

struct Blended {
  SampleTile surface;
  std::vector<SampleAccess> accesses;
  StageCounters counters;
};

const Sampling kMsaa8{CellGrid{}, standard_pattern(8)};

// In pixel (1, 2) only. `depth`: of the surface there, from 0 to 1.
Blended blended_at(const std::vector<std::uint32_t>& triangles, std::uint32_t mask, float depth = 1.0f,
                   std::uint32_t color_bytes = kSampleColorBytes) {
  const ShadedScene scene(sheets().trace);
  Blended result{SampleTile(kTile, kMsaa8, color_bytes), {}, {}};
  result.surface.over.assign(result.surface.triangle.size(), glm::vec4(0.0f));
  for (float& stored : result.surface.depth) stored = depth - 1;
  std::vector<SampleFragment> fragments;
  for (const std::uint32_t triangle : triangles) fragments.push_back({triangle, 0, 1, 2, mask});
  blend({scene.triangles, kTile, kMsaa8}, {scene.shader, kTile},
        {fragments, std::vector(fragments.size(), glm::vec2(0.5f))}, result.counters, result.surface, result.accesses);
  return result;
}

const std::size_t kFirst = (2 * 4 + 1) * 8;  // sample of pixel (1, 2)

TEST(Blend, LaterDrawsGoOverEarlierOnesWhateverTheirDepth) {
  // Red, then blue: blue over red. (0, 0, 1) / 4 + 3/4 x (1, 0, 0) / 2; alpha 1/4 + 3/4 / 2.
  EXPECT_EQ(blended_at({0, 2}, 1).surface.over[kFirst], glm::vec4(0.375f, 0, 0.25f, 0.625f));
  // Blue, then red, which lies behind it: (1, 0, 0) / 2 + 1/2 x (0, 0, 1) / 4.
  EXPECT_EQ(blended_at({2, 0}, 1).surface.over[kFirst], glm::vec4(0.5f, 0, 0.125f, 0.625f));
}

TEST(Blend, OnlySamplesOfTheMaskChange) {
  const Blended found = blended_at({0}, 0b1010u);
  for (std::size_t i = 0; i < found.surface.over.size(); ++i)
    EXPECT_EQ(found.surface.over[i].a, i == kFirst + 1 || i == kFirst + 3 ? 0.5f : 0.0f);
  ASSERT_EQ(found.accesses.size(), 1u);
  EXPECT_EQ(found.accesses[0].cell, 9u);
  EXPECT_EQ(found.accesses[0].tested, 0b1010u);
  EXPECT_EQ(found.accesses[0].passed, 0b1010u);
}

TEST(Blend, DepthIsTestedAndNotWritten) {
  const Blended hidden = blended_at({0, 2}, 0xffu, 0.4f);  // only blue is nearer
  EXPECT_EQ(hidden.surface.over[kFirst], glm::vec4(0, 0, 0.25f, 0.25f));
  for (const float depth : hidden.surface.depth) EXPECT_EQ(depth, 0.4f - 1);
  for (const std::uint32_t triangle : hidden.surface.triangle) EXPECT_EQ(triangle, kNoTriangle);
  EXPECT_EQ(hidden.accesses[0].passed, 0u);
  EXPECT_EQ(hidden.accesses[1].passed, 0xffu);
}

// Two fragments: planes of depth (a product and two sums with the anchor's difference; in double precision), eight
// samples each that are tested, and eight that pass.
TEST(Blend, CountsItsWork) {
  const Blended found = blended_at({0, 2}, 0xffu, 0.4f);
  EXPECT_EQ(found.counters.items_in, 16u);
  EXPECT_EQ(found.counters.items_out, 8u);
  EXPECT_EQ(found.counters.bytes_read, 16 * 4 + 2 * kSampleFragmentBytes + 8 * 6);
  EXPECT_EQ(found.counters.bytes_written, 8u * 6);
  EXPECT_EQ(found.counters.lanes_used, 16u);
  EXPECT_EQ(found.counters.lanes_issued, 16u);
  // A plane and a sample's test cost what they do in depth_test.
  const ShadedScene scene(sheets().trace);
  StageCounters depth;
  SampleTile surface(kTile, kMsaa8);
  for (float& stored : surface.depth) stored = 0.4f - 1;
  std::vector<SampleAccess> accesses;
  depth_test({scene.triangles, kTile, kMsaa8}, {{0, 0, 1, 2, 0xffu}, {2, 0, 1, 2, 0xffu}}, depth, surface, accesses);
  // A sample that passes: one difference, and in each channel a product and a sum, between conversions from and to
  // fp16.
  OperationCounts expected = depth.ops;
  expected += OperationCounts{.mul_add = 3, .add = 3 * 2, .convert = 6} * 8;
  EXPECT_EQ(found.counters.ops, expected);
}

// A layer has alpha: a product, a sum, and two conversions more for each of the eight samples that pass.
TEST(Blend, CountsTheAlphaOfLayers) {
  const Blended color = blended_at({0}, 0xffu), layer = blended_at({0}, 0xffu, 1.0f, 8);
  OperationCounts expected = color.counters.ops;
  expected += OperationCounts{.mul_add = 1, .add = 2, .convert = 2} * 8;
  EXPECT_EQ(layer.counters.ops, expected);
  EXPECT_EQ(layer.counters.bytes_written, 8u * 8);
}

}  // namespace beampipe::blend_test
