// ordered_test: sample fragments -> sample fragments that pass the stencil and depth tests, in the API's order.
//
// Depths are those of triangles or those that shaders gave, limited as RopRule says.
#pragma once

#include <vector>

#include "stages/cost/counters.h"
#include "stages/data/ordered_tile.h"
#include "stages/data/sample_fragment.h"
#include "stages/rop/rop_rules.h"

namespace beampipe {

// Clears what draws clear before them. Leaves of each fragment the samples that pass, and drops fragments of which none
// is left or whose draws write no colour. Replaces `accesses`: one for each fragment that tests or writes.
void ordered_test(const SampledTriangles& in, const RopRules& rules, StageCounters& counters, OrderedTile& surface,
                  std::vector<SampleFragment>& fragments, std::vector<OrderedAccess>& accesses);

}  // namespace beampipe
