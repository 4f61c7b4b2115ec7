// Polygon clipping (Sutherland and Hodgman 1974), for expectations in numbers of any kind.
#pragma once

#include <vector>

namespace beampipe {

// What lies where distance(vertex) >= 0. Crossings are mix(from, to, t), t from 0 to 1.
template <class Vertex, class Distance, class Mix>
std::vector<Vertex> clipped_polygon(const std::vector<Vertex>& polygon, const Distance& distance, const Mix& mix) {
  std::vector<Vertex> kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vertex &from = polygon[i], &to = polygon[(i + 1) % polygon.size()];
    const auto a = distance(from), b = distance(to);
    if (a >= 0) kept.push_back(from);
    if ((a >= 0) != (b >= 0)) kept.push_back(mix(from, to, decltype(a)(a / (a - b))));
  }
  return kept;
}

}  // namespace beampipe
