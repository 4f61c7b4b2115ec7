// Directions that a trace gives as numbers.
#pragma once

#include <cmath>
#include <glm/glm.hpp>
#include <optional>

namespace beampipe {

// The length is 1, to the precision of floats.
inline bool is_unit(const glm::dvec3& vector) { return std::abs(glm::length(vector) - 1) < 1e-6; }

// The vector with length 1, or nothing if it has no length or an infinite one. A unit vector is kept as it is, so that
// writing and reading change no bit.
inline std::optional<glm::vec3> unit_vector(const glm::dvec3& vector) {
  const double length = glm::length(vector);
  if (!(length > 0) || std::isinf(length)) return std::nullopt;
  return glm::vec3(is_unit(vector) ? vector : vector / length);
}

}  // namespace beampipe
