#include "traces/files/triangulate.h"

#include "tests/test.h"

namespace beampipe::triangulate_test {

using Corners = std::vector<glm::vec3>;

// Of triangles that all turn about the axis as the polygon does: counter-clockwise, or clockwise if it is reversed.
double total_area(const Corners& p, int axis, bool is_reversed = false) {
  double sum = 0;
  for (const glm::uvec3& t : triangulate(p)) {
    const double area = 0.5 * glm::cross(glm::dvec3(p[t.y] - p[t.x]), glm::dvec3(p[t.z] - p[t.x]))[axis];
    EXPECT_TRUE(is_reversed ? area <= 0 : area >= 0);
    sum += std::abs(area);
  }
  return sum;
}

TEST(Triangulate, CoversAStarOnceInEveryPlane) {
  for (int axis = 0; axis < 3; ++axis) {
    Corners star;
    for (int i = 0; i < 10; ++i) {
      const double angle = 3.14159265358979 * i / 5, radius = i % 2 == 0 ? 3 : 1;
      glm::vec3 corner(20.0f);
      corner[(axis + 1) % 3] += static_cast<float>(radius * std::cos(angle));
      corner[(axis + 2) % 3] += static_cast<float>(radius * std::sin(angle));
      star.push_back(corner);
    }
    const double expected = 10 * 0.5 * 3 * 1 * std::sin(3.14159265358979 / 5);
    EXPECT_EQ(triangulate(star).size(), 8u);
    EXPECT_NEAR(total_area(star, axis), expected, 1e-4) << axis;  // overlaps would add to it
    const Corners reversed(star.rbegin(), star.rend());
    EXPECT_NEAR(total_area(reversed, axis, true), expected, 1e-4) << axis;
  }
}

TEST(Triangulate, CutsACombThatHasFewEars) {
  Corners comb = {{0, 0, 0}, {9, 0, 0}};
  for (int x = 8; x >= 0; x -= 2) {
    for (const glm::vec3& p : {glm::vec3(x + 1, 5, 0), glm::vec3(x, 5, 0)}) comb.push_back(p);
    if (x > 0) {
      for (const glm::vec3& p : {glm::vec3(x, 1, 0), glm::vec3(x - 1, 1, 0)}) comb.push_back(p);
    }
  }
  EXPECT_EQ(triangulate(comb).size(), comb.size() - 2);
  EXPECT_NEAR(total_area(comb, 2), 9 + 5 * 4, 1e-9);
}

// An arrow far from the origin, whose dent a fan from its second corner would fill; from any corner, in both windings.
TEST(Triangulate, FillsNoDents) {
  Corners arrow = {{100, 50, 7}, {104, 50, 7}, {101, 51, 7}, {100, 54, 7}};
  for (int i = 0; i < 4; ++i) {
    std::rotate(arrow.begin(), arrow.begin() + 1, arrow.end());
    EXPECT_NEAR(total_area(arrow, 2), 4, 1e-6);
    EXPECT_NEAR(total_area(Corners(arrow.rbegin(), arrow.rend()), 2, true), 4, 1e-6);
  }
}

TEST(Triangulate, GivesTheSameNumberOfTrianglesForAnyPolygon) {
  EXPECT_EQ(triangulate(Corners(6, glm::vec3(1, 2, 3))).size(), 4u);                           // a point
  EXPECT_EQ(triangulate({{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {3, 3, 3}}).size(), 2u);             // a line
  EXPECT_EQ(triangulate({{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}}).size(), 2u);             // crossing itself
  EXPECT_EQ(triangulate({{0, 0, 0}, {1, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}).size(), 3u);  // a corner twice
  EXPECT_TRUE(triangulate({{0, 0, 0}, {1, 1, 1}}).empty());
}

}  // namespace beampipe::triangulate_test
