#include "simd/position_mask.h"

#include "simd/sample_mask.h"
#include "tests/simd/coverage_cases.h"
#include "tests/simd/every_target.h"

namespace beampipe::position_mask_test {

// By 64-bit integers, sample for sample.
WideMask mask_of_samples(const TriangleInPixelOf<std::int64_t>& t, int positions) {
  std::int64_t a[3], b[3], c[3];
  for (int k = 0; k < 3; ++k) {
    const EdgeInPixel<std::int64_t> edge = edge_in_pixel(t, k);
    a[k] = edge.a, b[k] = edge.b, c[k] = edge.c - !owns_its_samples(edge.a, edge.b);
  }
  WideMask mask;
  const std::vector<SamplePattern> patterns = cell_patterns(positions);
  for (std::size_t w = 0; w < patterns.size(); ++w) mask.words[w] = sample_mask_scalar(a, b, c, patterns[w]);
  return mask;
}

// The positions are those of cell_patterns, and the covered ones are those that samples find.
TEST(PositionMask, KernelAndTwinEqualSampleMasksOnRandomTriangles) {
  Random random(61);
  std::vector<TriangleInPixel> in;
  std::vector<TriangleInPixelOf<std::int64_t>> wide;
  for (int i = 0; i < 4'000; ++i) {
    const Triangle t = random_triangle(random);
    in.push_back(kernel_input(t)), wide.push_back(in_pixel(t));
  }
  for (const int positions : {32, 64, 128, 256}) {
    const PositionGrid grid(positions);
    std::vector<WideMask> expected;
    for (const TriangleInPixelOf<std::int64_t>& t : wide) {
      expected.push_back(mask_of_samples(t, positions));
      ASSERT_EQ(position_mask_scalar(t, grid), expected.back()) << "triangle " << expected.size() << ", " << positions;
    }
    on_every_target([&] {
      std::vector<WideMask> masks(in.size());
      position_masks(in.data(), in.size(), grid, masks.data());
      ASSERT_EQ(masks, expected) << positions;
    });
  }
}

// Slopes at the limit where the numbers change their type.
TEST(PositionMask, LongEdges) {
  Random random(62);
  const PositionGrid grid(256);
  constexpr std::int64_t kBorder = 1 << 20;
  on_every_target([&] {
    for (int i = 0; i < 2'000; ++i) {
      Triangle t;
      t.p[0] = {random.integer(-600, 600), random.integer(-600, 600)};
      t.p[1] = {t.p[0].x + kBorder + random.integer(-1, 1), t.p[0].y + random.integer(-300, 300)};
      t.p[2] = {t.p[0].x + random.integer(-300, 300), t.p[0].y + random.integer(-1, 1) - kBorder};
      t = oriented(t);
      if (t.area2() == 0) continue;
      const TriangleInPixel in = kernel_input(t);
      WideMask mask;
      position_masks(&in, 1, grid, &mask);
      ASSERT_EQ(mask, mask_of_samples(in_pixel(t), 256)) << "triangle " << i;
      ASSERT_EQ(position_mask_scalar(in_pixel(t), grid), mask) << "triangle " << i;
    }
  });
}

// An edge with the whole pixel inside is not tested, and one that only touches its corner is not either.
TEST(PositionMask, TestsTheEdgesThatCutThePixel) {
  const PositionGrid grid(256);
  const auto tested = [&](const Triangle& t) {
    const TriangleInPixel in = kernel_input(oriented(t));
    EdgesTested edges;
    WideMask mask;
    on_every_target([&] { edges = position_masks(&in, 1, grid, &mask); });
    return std::pair{edges.narrow, edges.wide};
  };
  const auto expect = [](std::uint64_t narrow, std::uint64_t wide) { return std::pair{narrow, wide}; };
  EXPECT_EQ(tested({{{-300, -300}, {1000, -300}, {-300, 1000}}}), expect(0, 0)) << "covers the pixel";
  EXPECT_EQ(tested({{{0, 0}, {600, 0}, {0, 600}}}), expect(0, 0)) << "owns its left and its top edge";
  EXPECT_EQ(tested({{{128, -300}, {1500, -300}, {128, 1500}}}), expect(1, 0));
  EXPECT_EQ(tested({{{128, 100}, {1500, 100}, {128, 1500}}}), expect(2, 0));
  EXPECT_EQ(tested({{{50, 50}, {200, 50}, {50, 200}}}), expect(3, 0));
  constexpr std::int64_t kFar = 1 << 21;
  EXPECT_EQ(tested({{{128, -kFar}, {kFar, 0}, {128, kFar}}}), expect(0, 1));
}

}  // namespace beampipe::position_mask_test
