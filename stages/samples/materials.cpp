#include "stages/samples/materials.h"

#include <algorithm>
#include <array>
#include <map>
#include <utility>

namespace beampipe {

std::vector<std::uint32_t> material_ids(const SetupTriangles& triangles, MaterialBy by) {
  if (by == MaterialBy::draw) return triangles.draws;
  std::map<std::array<float, 4>, std::uint32_t> numbers;
  std::vector<std::uint32_t> ids;
  ids.reserve(triangles.draws.size());
  for (std::size_t i = 0; i < triangles.draws.size(); ++i) {
    const glm::vec3& kd = triangles.attributes[i].kd;
    const std::array<float, 4> key = {static_cast<float>(triangles.draws[i]), kd.r, kd.g, kd.b};
    ids.push_back(numbers.emplace(key, static_cast<std::uint32_t>(numbers.size())).first->second);
  }
  return ids;
}

Materials::Materials(std::vector<std::uint32_t> numbers) : ids(std::move(numbers)) {
  const std::uint32_t most = ids.empty() ? 0 : *std::max_element(ids.begin(), ids.end());
  while (digits < 4 && most >> 8 * digits != 0) ++digits;
}

}  // namespace beampipe
