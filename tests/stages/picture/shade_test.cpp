#include "stages/picture/shade.h"

#include "tests/stages/beam_pixels.h"
#include "tests/stages/sample_pixels.h"

namespace beampipe::shade_test {

SetupTriangles with_attributes(const FlatAttributes& flat) {
  SetupTriangles triangles = triangles_of({{{0, 0}, {256, 0}, {0, 256}}});
  triangles.attributes[0] = flat;
  return triangles;
}

TEST(Shade, LambertIsTheCosineTowardsTheLight) {
  const glm::vec3 kd(0.5f, 1.0f, 2.0f), down(0, -1, 0), slanted(0.6f, -0.8f, 0);
  const auto color = [&](const glm::vec3& normal, const glm::vec3& light) {
    return shade_triangles(with_attributes({kd, normal, true}), {{{light}}, {}}).at(0);
  };
  EXPECT_EQ(color({0, 1, 0}, down), kd);
  EXPECT_EQ(color({0, -1, 0}, down), glm::vec3(0.0f));  // lit from behind
  EXPECT_EQ(color({1, 0, 0}, down), glm::vec3(0.0f));
  const glm::vec3 expected = 0.8f * kd, found = color({0, 1, 0}, slanted);
  for (int c = 0; c < 3; ++c) EXPECT_FLOAT_EQ(found[c], expected[c]);
}

TEST(Shade, UnlitIsKd) {
  const glm::vec3 kd(0.5f, 1.0f, 2.0f);
  EXPECT_EQ(shade_triangles(with_attributes({kd, {0, -1, 0}, false}), {{{glm::vec3(0, -1, 0)}}, {}}).at(0), kd);
  EXPECT_EQ(shade_triangles(with_attributes({kd, {0, 0, 0}, false}), {}).at(0), kd);
}

TEST(Shade, FragmentsGetTheirTrianglesColorTimesAlpha) {
  SetupTriangles triangles = triangles_of({
      {{64, -5'000}, {64, 5'000}, {-5'000, 0}}  // a quarter of the pixel
  });
  Fragments fragments = beam_fragments(triangles, {0, 0, 1, 1}, MaskSource::table);
  StageCounters counters;
  shade(std::vector<glm::vec3>{{1, 2, 4}}, fragments.list, counters);
  ASSERT_EQ(fragments.list.size(), 1u);
  EXPECT_NEAR(fragments.list[0].color[0], 0.25, 1e-6);
  EXPECT_NEAR(fragments.list[0].color[1], 0.5, 2e-6);
  EXPECT_NEAR(fragments.list[0].color[2], 1.0, 4e-6);
}

// A triangle in one pixel; two in the same pixel, which share no quad; and one that covers all of 8 x 8 pixels, 16
// whole quads.
TEST(Shade, QuadsOfEachTriangleHaveFourLanes) {
  const SetupTriangles in_a_pixel = triangles_of({{{3 * 256 + 20, 20}, {4 * 256 - 20, 30}, {3 * 256 + 30, 230}}});
  const SetupTriangles two = triangles_of({{{20, 20}, {230, 30}, {20, 230}}, {{240, 240}, {30, 240}, {240, 40}}});
  const SetupTriangles whole = triangles_of({everywhere(-0.5f)});
  struct Case {
    const SetupTriangles& triangles;
    std::uint64_t used, issued;
  };
  for (const auto& [triangles, used, issued] : {Case{in_a_pixel, 1, 4}, {two, 2, 8}, {whole, 64, 64}}) {
    const std::vector<glm::vec3> colors(triangles.triangles.size(), glm::vec3(1.0f));
    const Tile tile{0, 0, 8, 8};
    Fragments fragments = beam_fragments(triangles, tile, MaskSource::table);
    std::vector<SampleFragment> samples = sample_fragments(triangles, tile, {CellGrid{}, standard_pattern(8)});
    StageCounters of_fragments, of_samples;
    shade(colors, fragments.list, of_fragments);
    shade(colors, samples, kColorBytes, of_samples);
    for (const StageCounters& counters : {of_fragments, of_samples}) {
      EXPECT_EQ(counters.lanes_used, used);
      EXPECT_EQ(counters.lanes_issued, issued);
    }
  }
}

// fp16 has 11 significant bits. 1 + 2^-11 lies half-way between 1 and the next number and is rounded to the even one.
TEST(Shade, HalfRounding) {
  SetupTriangles triangles = with_attributes({{1.0f + 0x1p-11f, 1.0f + 0x1.8p-11f, 1e9f}, {}, false});
  add_triangle(triangles, {0, 0}, {256, 0}, {0, 256});
  triangles.attributes[1] = {{0.1f, 0, 0}, {}, false};
  const Trace trace;
  const Frame frame;
  const std::vector<glm::vec3> found =
      SurfaceShader(triangles, trace, frame, nullptr, {.stored_as = AccumulatorFormat::fp16}).flat_colors();
  EXPECT_EQ(found[0], glm::vec3(1.0f, 1.0f + 0x1p-10f, 65504.0f));
  EXPECT_NEAR(found[1].x, 0.1f, 0.1f * 0x1p-11f);
  EXPECT_NE(found[1].x, 0.1f);
}

}  // namespace beampipe::shade_test
