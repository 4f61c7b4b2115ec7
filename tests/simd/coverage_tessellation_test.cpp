// The areas of triangles that share edges add up to the area of what they tile.

#include "tests/simd/coverage_cases.h"

namespace beampipe::coverage_tessellation_test {

// Shared edges cancel exactly. What remains is the rounding of each triangle's own sum, 2^-24 for sums near 1.
constexpr double kPerTriangle = 0x1p-24;

TEST(CoverageTessellation, ReversedEdgeIntegratesToTheOppositeNumber) {
  Random random(7);
  for (int i = 0; i < 100'000; ++i) {
    const TriangleInPixelOf<std::int64_t> t = in_pixel(random_triangle(random));
    const EdgeInPixel<std::int64_t> edge = edge_in_pixel(t, 0);
    const auto a = static_cast<float>(edge.a), b = static_cast<float>(edge.b), c = static_cast<float>(edge.c),
               c_right = static_cast<float>(edge.c + 256 * edge.a), v0 = static_cast<float>(t.y[0]) / 256,
               v1 = static_cast<float>(t.y[1]) / 256;
    const EdgeIntegral<float> forth = edge_integral(v0, v1, a / 256, b / 256, c / 65536, c_right / 65536);
    const EdgeIntegral<float> back = edge_integral(v1, v0, -a / 256, -b / 256, -c / 65536, -c_right / 65536);
    ASSERT_EQ(forth.area, -back.area);
    ASSERT_EQ(forth.moment_u, -back.moment_u);
    ASSERT_EQ(forth.moment_v, -back.moment_v);
  }
}

TEST(CoverageTessellation, FansCloseThePixel) {
  Random random(8);
  for (int round = 0; round < 400; ++round) {
    const std::int64_t reach = round % 4 == 0 ? kLimit : 600, spokes = random.integer(3, 300);
    const Corner hub{random.integer(-100, 356), random.integer(-100, 356)};
    std::vector<Corner> rim = {{-reach, -reach}};  // points along the border of a square, including its corners
    const auto along = [&](std::int64_t n) { return -reach + 2 * reach * (n + 1) / (spokes + 1); };
    for (std::int64_t n = 0; n < spokes; ++n) rim.push_back({along(n), -reach});
    rim.push_back({reach, -reach});
    for (std::int64_t n = 0; n < spokes; ++n) rim.push_back({reach, along(n)});
    rim.push_back({reach, reach});
    rim.push_back({-reach, reach});
    double sum = 0;
    int triangles = 0;
    for (std::size_t i = 0; i < rim.size(); ++i) {
      const Triangle t{{hub, rim[i], rim[(i + 1) % rim.size()]}};
      if (t.area2() == 0) continue;
      const float alpha = coverage_on_float(oriented(t)).alpha;
      sum += alpha, triangles += alpha > 0;
    }
    ASSERT_NEAR(sum, 1.0, kPerTriangle * triangles) << triangles << " triangles";
  }
}

// A triangle's coverages of all pixels add up to its area. Each pixel sees the triangle from its own corner.
TEST(CoverageTessellation, PixelsShareOutTheTriangle) {
  Random random(11);
  for (int round = 0; round < 500; ++round) {
    Triangle t;
    for (Corner& corner : t.p) corner = {random.integer(0, 12 * 256), random.integer(0, 12 * 256)};
    if (t.area2() == 0) continue;
    t = oriented(t);
    double sum = 0;
    for (std::int64_t y = 0; y < 12; ++y)
      for (std::int64_t x = 0; x < 12; ++x) sum += coverage_on_float(t, x, y).alpha;
    ASSERT_NEAR(sum, static_cast<double>(t.area2()) / (2 * 65536), 144 * kPerTriangle);
  }
}

}  // namespace beampipe::coverage_tessellation_test
