// Cutouts of sample fragments, by hand.
#include "stages/samples/alpha_test.h"

#include "tests/stages/surface_scene.h"
#include "tests/test.h"

namespace beampipe::alpha_test_test {

// A rectangle that fills the tile, with alpha 0 in the left half of the texture, 160 / 255 in the right half.
struct Tested {
  std::vector<SampleFragment> fragments;
  StageCounters counters;
};

SurfaceTrace halves(AlphaMode mode) {
  SurfaceTrace scene = full_of({"halves", 2, 1, {{255, 255, 255, 0}, {255, 255, 255, 160}}}, mode);
  scene.base_texture().magnify = Filter::nearest;
  return scene;
}

Tested tested(const ShadedScene& scene, AlphaCoverage coverage, const std::vector<SampleFragment>& fragments,
              const std::vector<glm::vec2>& places, const CellGrid& grid = {}) {
  Tested result{fragments, {}};
  const Tile tile = scene.frame_tile();
  alpha_test({scene.shader, tile}, {tile, {grid, standard_pattern(8)}, coverage, places}, result.counters,
             result.fragments);
  return result;
}

TEST(AlphaTest, OneTestDecidesForAllSamples) {
  const ShadedScene scene(halves(AlphaMode::mask).trace);
  // Pixels 2, 4 and 5, and pixel 3 at a place in pixel 4, where a centre lies outside of its fragment.
  const Tested found = tested(scene, AlphaCoverage::test,
                              {{0, 0, 2, 1, 0xffu}, {0, 0, 4, 1, 0x81u}, {0, 1, 5, 1, 0xffu}, {0, 1, 3, 1, 0x0fu}},
                              {{0.5f, 0.5f}, {0.5f, 0.5f}, {0.1f, 0.5f}, {1.25f, 0.5f}});
  ASSERT_EQ(found.fragments.size(), 3u);
  EXPECT_EQ(found.fragments[0].x, 4);
  EXPECT_EQ(found.fragments[0].mask, 0x81u);
  EXPECT_EQ(found.fragments[1].x, 5);
  EXPECT_EQ(found.fragments[1].mask, 0xffu);
  EXPECT_EQ(found.fragments[2].x, 3);
  EXPECT_EQ(found.counters.items_in, 4u);
  EXPECT_EQ(found.counters.items_out, 3u);
}

TEST(AlphaTest, TheCutoffItselfPasses) {
  SurfaceTrace trace = halves(AlphaMode::mask);
  const float alpha = 160 / 255.0f;
  for (const float cutoff : {std::nextafter(alpha, 0.0f), alpha, std::nextafter(alpha, 1.0f)}) {
    trace.trace.materials[0].alpha_cutoff = cutoff;
    const ShadedScene scene(trace.trace);
    for (const AlphaCoverage coverage : {AlphaCoverage::test, AlphaCoverage::by_sample})
      EXPECT_EQ(tested(scene, coverage, {{0, 0, 6, 1, 0xffu}}, {glm::vec2(0.5f)}).fragments.size(),
                cutoff > alpha ? 0u : 1u);
  }
}

// 160 / 255 of 8 samples is 5.02, which is 5 or 6 of them. By hashes, pixels take different samples.
TEST(AlphaTest, CoverageAndHashesTakeThePartOfTheSamples) {
  const ShadedScene scene(halves(AlphaMode::mask).trace);
  for (const AlphaCoverage coverage : {AlphaCoverage::to_coverage, AlphaCoverage::hashed}) {
    std::set<std::uint32_t> masks;
    int sum = 0;
    for (std::int32_t y = 0; y < 8; ++y)
      for (std::int32_t x = 4; x < 8; ++x) {
        const Tested found = tested(scene, coverage, {{0, 0, x, y, 0xffu}}, {glm::vec2(0.5f)});
        ASSERT_EQ(found.fragments.size(), 1u);
        const int taken = std::popcount(found.fragments[0].mask);
        EXPECT_TRUE(taken == 5 || taken == 6) << taken;
        sum += taken, masks.insert(found.fragments[0].mask);
      }
    EXPECT_NEAR(sum / 32.0, 160 / 255.0 * 8, 0.2);
    EXPECT_TRUE(coverage == AlphaCoverage::to_coverage || masks.size() > 4);
    EXPECT_TRUE(tested(scene, coverage, {{0, 0, 1, 1, 0xffu}}, {glm::vec2(0.5f)}).fragments.empty());
  }
}

// The border of the texture's halves, x = 4, divides the samples of pixel 3 or 4; sample places are in 1/256 px.
TEST(AlphaTest, SamplesAreTestedOneByOne) {
  SurfaceTrace trace(8, 8);
  const TextureImage image{"halves", 2, 1, {{255, 255, 255, 0}, {255, 255, 255, 255}}};
  Material material = textured_material(trace.add_image(image), AlphaMode::mask);
  material.base_texture->magnify = Filter::nearest;
  trace.add_rectangle(0.5, 0, 8.5, 8, 0.5, material);  // the border lies at x = 4.5
  const ShadedScene scene(trace.trace);
  const SamplePattern pattern = standard_pattern(8);
  std::uint32_t expected = 0;
  for (int s = 0; s < 8; ++s)
    if (pattern.x[s] >= 128) expected |= 1u << s;
  const Tested found =
      tested(scene, AlphaCoverage::by_sample, {{0, 0, 4, 1, 0xffu}, {0, 0, 5, 1, 0x3u}, {0, 1, 3, 1, 0xffu}},
             std::vector<glm::vec2>(3, glm::vec2(0.5f)));
  ASSERT_EQ(found.fragments.size(), 2u);
  EXPECT_EQ(found.fragments[0].mask, expected);
  EXPECT_EQ(found.fragments[1].mask, 0x3u);
  // 18 tests. The first quad runs for each of its eight samples, and the second one too.
  EXPECT_EQ(found.counters.lanes_used, 18u);
  EXPECT_EQ(found.counters.lanes_issued, 64u);
}

// Several surfaces take the same samples, so that a cutout in front of itself does not show through.
TEST(AlphaTest, CoverageIsTheSameForAllSurfaces) {
  SurfaceTrace trace = halves(AlphaMode::mask);
  trace.add_rectangle(0, 0, 8, 8, 0.75, trace.trace.materials[0]);
  const ShadedScene scene(trace.trace);
  const Tested found = tested(scene, AlphaCoverage::to_coverage, {{0, 0, 6, 3, 0xffu}, {2, 0, 6, 3, 0xffu}},
                              {glm::vec2(0.5f), glm::vec2(0.5f)});
  ASSERT_EQ(found.fragments.size(), 2u);
  EXPECT_EQ(found.fragments[0].mask, found.fragments[1].mask);
}

TEST(AlphaTest, OtherFragmentsPass) {
  for (const AlphaMode mode : {AlphaMode::opaque, AlphaMode::blend}) {
    const ShadedScene scene(halves(mode).trace);
    const Tested found = tested(scene, AlphaCoverage::test, {{0, 0, 1, 1, 0xffu}}, {glm::vec2(0.5f)});
    ASSERT_EQ(found.fragments.size(), 1u);
    EXPECT_EQ(found.fragments[0].mask, 0xffu);
    EXPECT_EQ(found.counters.items_in, 0u);
  }
}

// Cells of super-resolved pixels: two columns of a pixel, which is pixel 3 or 4 of the texture's border.
TEST(AlphaTest, CellsAreTestedOneByOne) {
  const ShadedScene scene(halves(AlphaMode::mask).trace);
  const CellGrid grid{2, 1};
  const Tested found = tested(scene, AlphaCoverage::test, {{0, 0, 7, 1, 0xffu}, {0, 0, 8, 1, 0xffu}},
                              {{0.75f, 0.5f}, {0.25f, 0.5f}}, grid);
  ASSERT_EQ(found.fragments.size(), 1u);
  EXPECT_EQ(found.fragments[0].x, 8);
}

// Four invocations of each quad that find alpha, and for each fragment a comparison, or one for each sample.
TEST(AlphaTest, CountsItsWork) {
  const ShadedScene scene(halves(AlphaMode::mask).trace);
  for (const AlphaCoverage coverage : {AlphaCoverage::test, AlphaCoverage::to_coverage}) {
    const Tested found =
        tested(scene, coverage, {{0, 0, 6, 1, 0xffu}, {0, 1, 1, 1, 0xffu}}, {glm::vec2(0.5f), glm::vec2(0.5f)});
    EXPECT_EQ(found.counters.items_in, 2u);
    EXPECT_EQ(found.counters.items_out, 1u);
    EXPECT_EQ(found.counters.bytes_read, 2 * kSampleFragmentBytes);
    EXPECT_EQ(found.counters.bytes_written, kSampleFragmentBytes);
    EXPECT_EQ(found.counters.lanes_used, 2u);
    EXPECT_EQ(found.counters.lanes_issued, 8u);
    // As AlphaMask.CountsItsWork works out.
    OperationCounts expected = OperationCounts{.mul_add = 31, .add = 36, .fetch = 1, .special = 2} * 8;
    expected.add += coverage == AlphaCoverage::test ? 2 : 16;
    EXPECT_EQ(found.counters.ops, expected);
  }
  // A hash by hand. Squared slopes: 4 products, 3 additions. Cells: 2 additions, a root, a quotient; their power of two
  // and their share: 3 bits, 1 addition; the finer ones: 1 addition. For each of two sizes: 2 products, 4 limits, 2
  // integers; three times 6 bits and 2 products, 2 additions; 1 bit, 1 conversion, 1 product. Their mean: 1 product, 2
  // additions. Its distribution: 5 additions; 3 products, a limit and a quotient; a product, an addition and a
  // quotient; 5 additions to choose. Then 5 additions for each of 8 samples.
  OperationCounts expected = OperationCounts{.mul_add = 31, .add = 36, .fetch = 1, .special = 2} * 8;
  expected += OperationCounts{.mul_add = 27, .add = 33 + 8 * 5, .bit = 41, .special = 4, .convert = 6} * 2;
  EXPECT_EQ(tested(scene, AlphaCoverage::hashed, {{0, 0, 6, 1, 0xffu}, {0, 1, 1, 1, 0xffu}},
                   {glm::vec2(0.5f), glm::vec2(0.5f)})
                .counters.ops,
            expected);
  const Tested in_one_quad = tested(scene, AlphaCoverage::test, {{0, 0, 6, 1, 0xffu}, {0, 0, 7, 1, 0xffu}},
                                    {glm::vec2(0.5f), glm::vec2(0.5f)});
  EXPECT_EQ(in_one_quad.counters.lanes_issued, 4u);
}

}  // namespace beampipe::alpha_test_test
