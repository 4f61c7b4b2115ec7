#include "traces/closed_mesh.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <utility>

namespace beampipe {
namespace {

// Of each vertex: a number that all vertices at its position share.
std::vector<std::uint32_t> places_of(const std::vector<glm::vec3>& positions) {
  std::map<std::array<float, 3>, std::uint32_t> numbers;
  std::vector<std::uint32_t> places;
  places.reserve(positions.size());
  for (const glm::vec3& p : positions)
    places.push_back(
        numbers.emplace(std::array{p.x, p.y, p.z}, static_cast<std::uint32_t>(numbers.size())).first->second);
  return places;
}

}  // namespace

bool is_closed(const Mesh& mesh) {
  const std::vector<std::uint32_t> places = places_of(mesh.positions);
  using Edge = std::pair<std::uint32_t, std::uint32_t>;
  std::vector<std::pair<Edge, bool>> sides;  // an edge's lower place comes first; does the triangle run upwards?
  sides.reserve(3 * mesh.triangles.size());
  for (const glm::uvec3& t : mesh.triangles) {
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t a = places[t[k]], b = places[t[(k + 1) % 3]];
      if (a != b) sides.push_back({std::minmax(a, b), a < b});
    }
  }
  std::ranges::sort(sides);
  for (auto side = sides.begin(); side != sides.end();) {
    const Edge edge = side->first;
    int upwards = 0;
    for (; side != sides.end() && side->first == edge; ++side) upwards += side->second ? 1 : -1;
    if (upwards != 0) return false;
  }
  return true;
}

bool is_closed_body(const Mesh& mesh) {
  double volume = 0;  // six times
  for (const glm::uvec3& t : mesh.triangles)
    volume += glm::dot(glm::dvec3(mesh.positions[t.x]),
                       glm::cross(glm::dvec3(mesh.positions[t.y]), glm::dvec3(mesh.positions[t.z])));
  return volume > 0 && is_closed(mesh);
}

}  // namespace beampipe
