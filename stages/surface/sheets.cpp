#include "stages/surface/sheets.h"

#include <algorithm>
#include <numeric>
#include <tuple>

namespace beampipe {
namespace {

// Sets of triangles that grow together.
class Groups {
 public:
  explicit Groups(std::size_t triangles) : parents_(triangles) { std::iota(parents_.begin(), parents_.end(), 0u); }

  void join(std::uint32_t a, std::uint32_t b) {
    a = first_of(a), b = first_of(b);
    parents_[std::max(a, b)] = std::min(a, b);
  }

  // The triangle of the group that comes first.
  std::uint32_t first_of(std::uint32_t triangle) {
    while (parents_[triangle] != triangle) triangle = parents_[triangle] = parents_[parents_[triangle]];
    return triangle;
  }

 private:
  std::vector<std::uint32_t> parents_;
};

// A side of a triangle. The triangle lies to the same hand of all sides that face the same way, going from `from` to
// `to`. Vertices of different draws have different numbers.
struct Side {
  std::uint32_t from, to;
  bool front;
  std::uint32_t triangle;

  auto edge() const { return std::tuple(std::min(from, to), std::max(from, to), front); }
};

bool is_part_of_same(const SetupTriangles& triangles, std::uint32_t a, std::uint32_t b) {
  return triangles.surfaces[a].vertices == triangles.surfaces[b].vertices;
}

// Of all triangles that are not opaque. Of the parts of a clipped triangle, the first one has the sides.
std::vector<Side> sides_of(const SetupTriangles& triangles, Groups& groups) {
  std::vector<Side> sides;
  for (std::uint32_t i = 0; i < triangles.surfaces.size(); ++i) {
    if (triangles.is_opaque(i)) continue;
    if (i > 0 && !triangles.is_opaque(i - 1) && is_part_of_same(triangles, i - 1, i)) {
      groups.join(i - 1, i);
      continue;
    }
    const auto& vertices = triangles.surfaces[i].vertices;
    for (std::size_t k = 0; k < 3; ++k)
      sides.push_back({vertices[k], vertices[(k + 1) % 3], triangles.triangles[i].front, i});
  }
  return sides;
}

}  // namespace

std::vector<std::uint32_t> number_sheets(const SetupTriangles& triangles) {
  Groups groups(triangles.surfaces.size());
  std::vector<Side> sides = sides_of(triangles, groups);
  std::ranges::sort(sides, {}, [](const Side& side) { return std::tuple(side.edge(), side.triangle); });
  for (std::size_t first = 0, end = 0; first < sides.size(); first = end) {
    while (end < sides.size() && sides[end].edge() == sides[first].edge()) ++end;
    if (end == first + 2 && sides[first].from == sides[first + 1].to)
      groups.join(sides[first].triangle, sides[first + 1].triangle);
  }

  std::vector<std::uint32_t> sheets(triangles.surfaces.size());
  std::uint32_t count = 0;
  for (std::uint32_t i = 0; i < sheets.size(); ++i) {
    if (triangles.is_opaque(i)) continue;
    const std::uint32_t first = groups.first_of(i);
    sheets[i] = first == i ? count++ : sheets[first];
  }
  return sheets;
}

}  // namespace beampipe
