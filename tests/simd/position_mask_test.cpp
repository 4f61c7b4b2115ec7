#include "simd/position_mask.h"

#include "simd/sample_mask.h"
#include "tests/simd/coverage_cases.h"
#include "tests/simd/every_target.h"

namespace beampipe::position_mask_test {

TEST(PositionMask, KernelEqualsTwinOnRandomTriangles) {
  Random random(61);
  std::vector<TriangleInPixel> in;
  std::vector<TriangleInPixelOf<std::int64_t>> wide;
  for (int i = 0; i < 4'000; ++i) {
    const Triangle t = random_triangle(random);
    in.push_back(kernel_input(t)), wide.push_back(in_pixel(t));
  }
  for (const int positions : {32, 64, 128, 256}) {
    const PositionGrid grid(positions);
    on_every_target([&] {
      std::vector<WideMask> masks(in.size());
      position_masks(in.data(), in.size(), grid, masks.data());
      for (std::size_t i = 0; i < in.size(); ++i)
        ASSERT_EQ(masks[i], position_mask_scalar(wide[i], grid)) << "triangle " << i << ", " << positions;
    });
  }
}

// Slopes at the limit where the kernel changes its number type.
TEST(PositionMask, KernelEqualsTwinOnLongEdges) {
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
      ASSERT_EQ(mask, position_mask_scalar(in_pixel(t), grid)) << "triangle " << i;
    }
  });
}

// The positions are those of cell_patterns, and the covered ones are those that sample_masks finds.
TEST(PositionMask, EqualsSampleMasksOfTheSamePositions) {
  Random random(63);
  for (const int positions : {32, 64, 128, 256}) {
    const PositionGrid grid(positions);
    const std::vector<SamplePattern> patterns = cell_patterns(positions);
    for (int i = 0; i < 2'000; ++i) {
      const TriangleInPixelOf<std::int64_t> t = in_pixel(random_triangle(random));
      std::int64_t a[3], b[3], c[3];
      for (int k = 0; k < 3; ++k) {
        const EdgeInPixel<std::int64_t> edge = edge_in_pixel(t, k);
        a[k] = edge.a, b[k] = edge.b, c[k] = edge.c - !owns_its_samples(edge.a, edge.b);
      }
      const WideMask mask = position_mask_scalar(t, grid);
      for (std::size_t word = 0; word < patterns.size(); ++word)
        ASSERT_EQ(mask.words[word], sample_mask_scalar(a, b, c, patterns[word])) << "triangle " << i;
    }
  }
}

}  // namespace beampipe::position_mask_test
