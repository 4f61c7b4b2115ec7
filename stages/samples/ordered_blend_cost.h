// What ordered_blend is charged.
#pragma once

#include "stages/cost/counting.h"
#include "stages/rop/rop_formulas.h"
#include "stages/rop/rop_rules.h"

namespace beampipe {

// Per sample: its channels, to the stored format and, where they are read, from it.
inline OperationCounts ordered_blend_cost(const RopRule& rule, int channels) {
  return count_operations([&](OperationCounts& counts) {
    const Counted<float> one(1.0f, counts);
    Counted<float> stored[4];
    for (int c = 0; c < 4; ++c) stored[c] = one;
    const Counted<float> source[4] = {one, one, one, one};
    for (int c = 0; rule.blend && c < channels; ++c) stored[c] = converted(one);
    for (int c = 0; c < channels; ++c) {
      if ((rule.color_mask >> c & 1) == 0) continue;
      converted(rule.blend ? blended_channel(*rule.blend, c, source, stored) : one);
    }
  });
}

}  // namespace beampipe
