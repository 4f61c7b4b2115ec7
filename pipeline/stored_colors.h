// Colours as a frame's target stores them, and as pictures show them: linear RGB.
#pragma once

#include <glm/glm.hpp>

#include "traces/srgb.h"
#include "traces/trace.h"

namespace beampipe {

inline float shown(ColorTarget target, float stored) {
  return target == ColorTarget::unorm ? static_cast<float>(linear_of_srgb(stored)) : stored;
}
inline glm::vec3 shown(ColorTarget target, const glm::vec3& stored) {
  return {shown(target, stored.r), shown(target, stored.g), shown(target, stored.b)};
}

// The inverse, of a colour in a picture.
inline double stored(ColorTarget target, double shown) {
  return target == ColorTarget::unorm ? encoded_as_srgb(shown) : shown;
}
inline glm::dvec3 stored(ColorTarget target, const glm::dvec3& shown) {
  return {stored(target, shown.r), stored(target, shown.g), stored(target, shown.b)};
}

}  // namespace beampipe
