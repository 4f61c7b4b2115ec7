// What alpha_test is charged.
#pragma once

#include "stages/cost/counting.h"
#include "stages/data/sample_fragment.h"

namespace beampipe {

// `tested`: fragments of cutouts, `left`: those that remain. `ranked`: samples whose rank alpha is compared with.
// `alphas`: what finding alpha once for each fragment costs; all four invocations of a quad do it.
inline void charge_alpha_test(std::uint64_t tested, std::uint64_t left, int ranked, const OperationCounts& alphas,
                              StageCounters& counters) {
  counters.items_in += tested;
  counters.items_out += left;
  counters.ops += OperationCounts{.add = 1} * (ranked > 0 ? tested * static_cast<std::uint64_t>(ranked) : tested);
  counters.ops += alphas * 4;
  counters.bytes_read += tested * kSampleFragmentBytes;
  counters.bytes_written += left * kSampleFragmentBytes;
  counters.lanes_used += tested;
  counters.lanes_issued += 4 * tested;
}

}  // namespace beampipe
