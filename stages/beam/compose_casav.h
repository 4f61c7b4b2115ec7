// compose: fragments from near to far -> one aggregate per pixel, by the published rules. It is the ROP of their
// pipeline. compose_over does the same for `alpha`, without masks. The file is named after the rules because every
// technique has its own `compose`.
#pragma once

#include <vector>

#include "simd/merge.h"
#include "stages/cost/counters.h"
#include "stages/data/casav_aggregate.h"
#include "stages/data/fragment.h"
#include "stages/data/pixel_observer.h"
#include "stages/data/sorted_lists.h"

namespace beampipe {

// Merges by the published rules (simd/merge.h). `buffer`: the lists of `fragments`. Returns one aggregate per pixel of
// the tile, kEmptyAggregate where nothing is.
std::vector<Aggregate> compose(const std::vector<Fragment>& fragments, const ABuffer& buffer,
                               const CasavMerging& merging, StageCounters& counters,
                               const PixelObservers* observers = nullptr);

// Sizes in the modelled machine of an aggregate and of a fragment for compose_over, which needs neither masks nor
// slabs. The aggregate has coverage and colour. The fragment also has the depth that it is sorted by.
inline constexpr std::uint32_t kOverBytes = 4 + kAggregateColorBytes;
inline constexpr std::uint32_t kOverFragmentBytes = kOverBytes + 4;

// Plain OVER: blends alpha and colour as if every fragment were independent of every other.
std::vector<Aggregate> compose_over(const std::vector<Fragment>& fragments, const ABuffer& buffer,
                                    StageCounters& counters, const PixelObservers* observers = nullptr);

}  // namespace beampipe
