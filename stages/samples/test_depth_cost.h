// What depth_test and depth_test_equal are charged.
#pragma once

#include "simd/depth_compare.h"
#include "stages/cost/counting.h"
#include "stages/data/pixel_depth.h"
#include "stages/data/sample_tile.h"

namespace beampipe {

// Of either test, per sample.
inline OperationCounts sample_depth_cost() {
  return count_operations([](OperationCounts& counts) {
    const Counted<float> one(1.0f, counts);
    Counted<float> depth;
    depth_test_scalar(one, one, one, one, one, one, depth);
  });
}

// Per fragment: its depth plane in the cell.
inline OperationCounts cell_plane_cost() {
  return count_operations([](OperationCounts& counts) {
    const Counted<double> one(1.0, counts);
    cell_plane<Counted<double>>({one, one, one, one, one}, one, one);
  });
}

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
