#include "traces/files/triangulate.h"

#include <cmath>
#include <cstdint>
#include <numeric>

namespace beampipe {
namespace {

using Points = std::vector<glm::dvec2>;

double cross(const glm::dvec2& a, const glm::dvec2& b) { return a.x * b.y - a.y * b.x; }

// Twice the signed area of a triangle, which is positive if it is counter-clockwise.
double area(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) { return cross(b - a, c - a); }

// Projects along the axis in which the polygon's normal (Newell's) is longest, so that the polygon is
// counter-clockwise.
Points project(const std::vector<glm::vec3>& corners) {
  const glm::dvec3 origin(corners[0]);
  glm::dvec3 normal(0.0);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    normal += glm::cross(glm::dvec3(corners[i]) - origin, glm::dvec3(corners[(i + 1) % corners.size()]) - origin);
  }
  const glm::dvec3 size = glm::abs(normal);
  const int z = size.x > size.y ? (size.x > size.z ? 0 : 2) : (size.y > size.z ? 1 : 2);
  const int x = normal[z] < 0 ? (z + 2) % 3 : (z + 1) % 3;
  const int y = 3 - z - x;
  Points points;
  for (const glm::vec3& corner : corners) {
    const glm::dvec3 p = glm::dvec3(corner) - origin;
    points.emplace_back(p[x], p[y]);
  }
  return points;
}

// The corner ring[i] can be cut off: it is convex, and no other corner lies in or on its triangle.
bool is_ear(const Points& points, const std::vector<std::uint32_t>& ring, std::size_t i) {
  const std::size_t n = ring.size();
  const glm::dvec2 a = points[ring[(i + n - 1) % n]], b = points[ring[i]], c = points[ring[(i + 1) % n]];
  if (!(area(a, b, c) > 0)) return false;
  for (std::uint32_t corner : ring) {
    const glm::dvec2 p = points[corner];
    if (p == a || p == b || p == c) continue;
    if (area(a, b, p) >= 0 && area(b, c, p) >= 0 && area(c, a, p) >= 0) return false;
  }
  return true;
}

}  // namespace

std::vector<glm::uvec3> triangulate(const std::vector<glm::vec3>& corners) {
  if (corners.size() < 3) return {};
  if (corners.size() == 3) return {{0, 1, 2}};
  const Points points = project(corners);
  std::vector<std::uint32_t> ring(corners.size());
  std::iota(ring.begin(), ring.end(), 0u);
  std::vector<glm::uvec3> triangles;
  // Starting at the second corner makes a convex polygon a fan around its first one.
  for (std::size_t i = 1; ring.size() >= 3;) {
    const std::size_t n = ring.size();
    std::size_t tries = 0;
    while (tries < n && !is_ear(points, ring, (i + tries) % n)) ++tries;
    i = (i + tries) % n;  // if there is no ear, any corner will do
    triangles.emplace_back(ring[(i + n - 1) % n], ring[i], ring[(i + 1) % n]);
    ring.erase(ring.begin() + static_cast<std::ptrdiff_t>(i));
    i = ring.size() > i ? i : 1;
  }
  return triangles;
}

}  // namespace beampipe
