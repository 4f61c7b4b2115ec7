// What depth_test and depth_test_equal are charged.
#pragma once

#include "stages/cost/counting.h"
#include "stages/data/sample_tile.h"
#include "stages/samples/sample_depth_cost.h"

namespace beampipe {

// `bytes_written`: per sample that passes.
inline void charge_depth_test(std::uint64_t fragments, const SampleCounts& samples, std::uint32_t bytes_written,
                              const SamplePattern& pattern, StageCounters& counters) {
  counters.items_in += samples.tested;
  counters.items_out += samples.passed;
  counters.ops += cell_plane_cost() * fragments;
  counters.ops += sample_depth_cost() * samples.tested;
  counters.bytes_read += samples.tested * kSampleDepthBytes + fragments * kSampleFragmentBytes;
  counters.bytes_written += samples.passed * bytes_written;
  counters.lanes_used += samples.tested;
  counters.lanes_issued += fragments * static_cast<std::uint64_t>(pattern.count);
}

}  // namespace beampipe
