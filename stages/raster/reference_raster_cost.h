// What reference_raster and its resolve are charged.
#pragma once

#include "simd/depth_span.h"
#include "stages/cost/counting.h"
#include "stages/raster/reference_raster.h"

namespace beampipe {

// The depth test of one sample.
inline OperationCounts reference_sample_cost() {
  return count_operations([](OperationCounts& counts) {
    const Counted<double> one(1.0, counts);
    Counted<double> depth;
    depth_span_sample({one, one, one, one, one}, one, one, depth);
  });
}

// `covered`: samples that were tested; `nearer`: samples that passed.
inline void charge_reference(std::uint64_t covered, std::uint64_t nearer, StageCounters& counters) {
  counters.items_out += nearer;
  counters.ops += reference_sample_cost() * covered;
  counters.bytes_read += covered * sizeof(double);
  counters.lanes_used += covered;
  counters.lanes_issued += covered;
}

// Three channels are summed over the samples of each pixel and divided.
inline void charge_reference_resolve(std::uint64_t pixels, std::uint64_t samples, StageCounters& counters) {
  constexpr OperationCounts sum{.add = 3}, mean{.mul_add = 3};
  counters.items_in += pixels * samples;
  counters.items_out += pixels;
  counters.ops += sum * (pixels * samples);
  counters.ops += mean * pixels;
  counters.bytes_read += pixels * samples * sizeof(std::uint64_t);
  counters.bytes_written += pixels * sizeof(glm::vec4);
}

}  // namespace beampipe
