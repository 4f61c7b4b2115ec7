// compose: fragments from near to far -> one aggregate per pixel. The ROP of the beam pipeline.
#pragma once

#include <vector>

#include "simd/merge.h"
#include "stages/beam/a_buffer.h"
#include "stages/cost/counters.h"
#include "stages/data/paper_aggregate.h"

namespace beampipe {

// A fragment as the paper's rules see it: with 32 mask positions.
MergeFragment merge_fragment(const Fragment& fragment);

// The paper's rules (simd/merge.h). One aggregate per pixel of the tile; kEmptyAggregate where nothing is.
std::vector<Aggregate> compose(const std::vector<Fragment>& fragments, const ABuffer& buffer,
                               const SamplePattern& pattern, const MergeRules& rules, PaperStorage storage,
                               StageCounters& counters);

// OVER alone has no masks and slabs: coverage and colour; a fragment has the depth that it is sorted by as well.
inline constexpr std::uint32_t kOverBytes = 4 + kAggregateColorBytes;
inline constexpr std::uint32_t kOverFragmentBytes = kOverBytes + 4;

// Plain OVER: alpha and colour, as if every fragment were independent of every other.
std::vector<Aggregate> compose_over(const std::vector<Fragment>& fragments, const ABuffer& buffer,
                                    StageCounters& counters);

}  // namespace beampipe
