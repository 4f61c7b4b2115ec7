// What blend is charged.
#pragma once

#include "stages/cost/counting.h"
#include "stages/cost/plane_cost.h"
#include "stages/data/sample_tile.h"

namespace beampipe {

// A channel of a premultiplied colour over what is there.
template <class Real>
Real blended(const Real& source, const Real& there, const Real& alpha) {
  return source + there * (Real(1.0f) - alpha);
}

// Per sample: its channels, from and to the stored format.
inline OperationCounts blend_cost(std::uint32_t channels) {
  return count_operations([&](OperationCounts& counts) {
    const Counted<float> one(1.0f, counts);
    for (std::uint32_t c = 0; c < channels; ++c) converted(blended(one, converted(one), one));
  });
}

// `color_bytes`: of a sample, which is read and written.
inline void charge_blend(std::uint64_t fragments, const SampleCounts& samples, std::uint32_t channels,
                         std::uint32_t color_bytes, const SamplePattern& pattern, StageCounters& counters) {
  counters.items_in += samples.tested;
  counters.items_out += samples.passed;
  counters.ops += cell_plane_cost() * fragments;
  counters.ops += depth_test_cost() * samples.tested;
  counters.ops += blend_cost(channels) * samples.passed;
  counters.bytes_read += samples.tested * kSampleDepthBytes + fragments * kSampleFragmentBytes;
  counters.bytes_read += samples.passed * color_bytes;
  counters.bytes_written += samples.passed * color_bytes;
  counters.lanes_used += samples.tested;
  counters.lanes_issued += fragments * static_cast<std::uint64_t>(pattern.count);
}

}  // namespace beampipe
