// What depth_test, depth_test_equal and depth_test_in_shader are charged.
#pragma once

#include "stages/cost/counting.h"
#include "stages/cost/plane_cost.h"
#include "stages/data/sample_tile.h"

namespace beampipe {

// `bytes_written`: per sample that passes.
inline void charge_depth_test(std::uint64_t fragments, const SampleCounts& samples, std::uint32_t bytes_written,
                              const SamplePattern& pattern, StageCounters& counters) {
  counters.items_in += samples.tested;
  counters.items_out += samples.passed;
  counters.ops += cell_plane_cost() * fragments;
  counters.ops += depth_test_cost() * samples.tested;
  counters.bytes_read += samples.tested * kSampleDepthBytes + fragments * kSampleFragmentBytes;
  counters.bytes_written += samples.passed * bytes_written;
  counters.lanes_used += samples.tested;
  counters.lanes_issued += fragments * static_cast<std::uint64_t>(pattern.count);
}

// `left`: those of the launched quads that have a visible sample.
inline void charge_depth_test_in_shader(std::uint64_t launched, std::uint64_t left, const SampleCounts& samples,
                                        const SamplePattern& pattern, StageCounters& counters) {
  const std::uint64_t invocations = 4 * launched;
  counters.ops += cell_plane_cost() * invocations;
  counters.ops += depth_test_cost() * (invocations * static_cast<std::uint64_t>(pattern.count));
  counters.bytes_read += samples.tested * kSampleDepthBytes;
  counters.lanes_issued += 4 * (launched - left);
}

}  // namespace beampipe
