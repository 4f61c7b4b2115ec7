// ordered_blend: shaded sample fragments -> the colours of samples, in the API's order.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "stages/cost/counters.h"
#include "stages/data/ordered_tile.h"
#include "stages/data/sample_fragment.h"
#include "stages/rop/rop_rules.h"

namespace beampipe {

struct ColoredFragments {
  const std::vector<SampleFragment>& list;  // whose samples passed all tests
  const std::vector<glm::vec4>& colors;     // RGBA
};

// Colours are rounded to the surface's format after each fragment. Replaces `accesses` by one for each fragment.
void ordered_blend(const SampledTriangles& in, const RopRules& rules, const ColoredFragments& fragments,
                   StageCounters& counters, OrderedTile& surface, std::vector<OrderedAccess>& accesses);

}  // namespace beampipe
