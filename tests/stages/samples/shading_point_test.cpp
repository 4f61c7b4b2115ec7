// Compares shading points with closed forms.
#include "stages/samples/shading_point.h"

#include "tests/stages/sample_pixels.h"

namespace beampipe::shading_point_test {

constexpr Tile kTile{0, 0, 8, 8};

TEST(ShadingPoint, IsTheMeanOfTheCoveredSamplesWhereTheCentreIsNotCovered) {
  SetupTriangles triangles = triangles_of({
      left_of(2 * 256 + 100, -0.5f)  // the left 100/256 of pixel 2, without its centre
  });
  const Sampling sampling{CellGrid{}, standard_pattern(4)};
  bool tried = false;
  for (const SampleFragment& fragment : sample_fragments(triangles, kTile, sampling)) {
    const SetupTriangle& triangle = triangles.triangles[0];
    const glm::dvec2 centre(fragment.x + 0.5, fragment.y + 0.5);
    EXPECT_EQ(shading_point(triangle, fragment, sampling, ShadeAt::centre).position, centre);
    const ShadingPoint point = shading_point(triangle, fragment, sampling, ShadeAt::centroid);
    EXPECT_EQ(point.is_centre, fragment.x < 2);
    if (point.is_centre) {
      EXPECT_EQ(point.position, centre);
      continue;
    }
    tried = true;
    // The standard samples are at (-2, -6), (6, -2), (-6, 2) and (2, 6) sixteenths from the centre. The triangle covers
    // the first and the third.
    EXPECT_EQ(point.position, centre + glm::dvec2(-4, -2) / 16.0);
  }
  EXPECT_TRUE(tried);
}

// An attribute that varies across a triangle, here its depth, leaves the range of the vertices if it is extrapolated,
// and all the more the steeper its gradient is. At the centroid it stays within the range.
TEST(ShadingPoint, ExtrapolatesAtTheCentreOnly) {
  for (const Sampling& sampling :
       {Sampling{CellGrid{}, standard_pattern(8)}, Sampling{CellGrid{2, 2}, standard_pattern(8, 128, 128)}}) {
    SetupTriangles triangles;
    for (std::int32_t i = 0; i < 7; ++i)  // slivers a third of a pixel wide; depth goes from 0 to 1 within 90/256 px
      add_triangle(triangles, {i * 290 + 20, 0, 0.0f}, {i * 290 + 110, 0, 1.0f}, {i * 290 + 60, 2048, 0.5f});
    double farthest = 0;
    for (const SampleFragment& fragment : sample_fragments(triangles, kTile, sampling)) {
      const SetupTriangle& triangle = triangles.triangles[fragment.triangle];
      const auto value = [&](ShadeAt at) {
        const glm::dvec2 point = shading_point(triangle, fragment, sampling, at).position;
        return triangle.depth.at(point.x, point.y);
      };
      farthest = std::max(farthest, std::max(value(ShadeAt::centre) - 1, -value(ShadeAt::centre)));
      EXPECT_GE(value(ShadeAt::centroid), -1e-9);
      EXPECT_LE(value(ShadeAt::centroid), 1 + 1e-9);
    }
    EXPECT_GT(farthest, 0.25);
  }
}

TEST(ShadingPoint, CountsWhatItLooksAt) {
  SetupTriangles triangles = triangles_of({left_of(2 * 256 + 100, -0.5f)});
  const Sampling sampling{CellGrid{}, standard_pattern(4)};
  StageCounters counters;
  std::vector<float> centroids(kTile.pixels());
  count_centroids(triangles, sample_fragments(triangles, kTile, sampling), kTile, sampling, counters, centroids);
  for (std::size_t i = 0; i < centroids.size(); ++i) EXPECT_EQ(centroids[i], i % 8 == 2) << i;
  // For each of 3 x 8 fragments and each of three edges: two products, two sums, a comparison. For each of 8 fragments:
  // per sample a bit, the test whether it is set, two selections and two sums; then the number of bits, a division and
  // two products.
  OperationCounts all = OperationCounts{.mul_add = 3 * 2, .add = 3 * 3} * 24;
  all += OperationCounts{.mul_add = 2, .add = 4 * 5, .bit = 4 + 1, .special = 1, .convert = 1} * 8;
  EXPECT_EQ(counters.ops, all);
}

}  // namespace beampipe::shading_point_test
