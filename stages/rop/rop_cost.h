// What tests and blending cost, of a sample or a region.
#pragma once

#include "stages/cost/counting.h"
#include "stages/rop/rop_formulas.h"
#include "stages/rop/rop_rules.h"

namespace beampipe {

inline OperationCounts stencil_test_cost(const Stencil& stencil) {
  return count_operations(
      [&](OperationCounts& counts) { stencil_passes(stencil, Counted<std::uint32_t>(1u, counts)); });
}
inline OperationCounts stencil_operation_cost(StencilOperation operation, const Stencil& stencil) {
  return count_operations(
      [&](OperationCounts& counts) { stencil_after(operation, stencil, Counted<std::uint32_t>(1u, counts)); });
}

// The first channels of a colour, to the stored format and, where they are read, from it.
inline OperationCounts stored_color_cost(const RopRule& rule, int channels) {
  return count_operations([&](OperationCounts& counts) {
    const Counted<float> one(1.0f, counts);
    const Counted<float> source[4] = {one, one, one, one};
    Counted<float> stored[4] = {one, one, one, one};
    for (int c = 0; rule.blend && c < channels; ++c) stored[c] = converted(one);
    for (int c = 0; c < channels; ++c)
      if (rule.color_mask >> c & 1) converted(rule.blend ? blended_channel(*rule.blend, c, source, stored) : one);
  });
}

}  // namespace beampipe
