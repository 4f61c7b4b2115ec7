// What is stored after a fragment's colour has come.
#pragma once

#include <glm/glm.hpp>

#include "stages/rop/rop_formulas.h"
#include "stages/rop/rop_rules.h"

namespace beampipe {

// RGBA. `before`: what was stored; `rounded(channel)`: a number in the format that is stored.
template <class Rounded>
glm::vec4 stored_color(const RopRules& rules, const RopRule& rule, const glm::vec4& source, const glm::vec4& before,
                       Rounded&& rounded) {
  glm::vec4 result = source;
  for (int c = 0; rule.blend && c < 4; ++c) result[c] = blended_channel(*rule.blend, c, &source[0], &before[0]);
  if (rules.limits_color) result = glm::clamp(result, 0.0f, 1.0f);
  for (int c = 0; c < 4; ++c) result[c] = rule.color_mask >> c & 1 ? rounded(result[c]) : before[c];
  return result;
}

}  // namespace beampipe
