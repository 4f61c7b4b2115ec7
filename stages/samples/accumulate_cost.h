// What accumulate, stencil_test and the resolve of accumulators are charged.
#pragma once

#include "stages/cost/counting.h"
#include "stages/data/accumulator.h"
#include "stages/data/pixel_formats.h"
#include "stages/data/sample_tile.h"
#include "stages/samples/sample_formulas.h"

namespace beampipe {

// To add a fragment to its pixel's accumulator.
inline OperationCounts accumulation_cost(bool saturate) {
  return count_operations([&](OperationCounts& counts) {
    const Counted<float> one(1.0f, counts), color[4] = {one, one, one, one};
    Counted<float> sum[4] = {one, one, one, one};
    convert_sum(sum);
    add_weighted(color, bit_count(Counted<std::uint32_t>(1, counts)) * one, saturate, one, sum);
    convert_sum(sum);
  });
}

inline OperationCounts accumulator_resolve_cost() {
  return count_operations([](OperationCounts& counts) {
    const Counted<float> one(1.0f, counts);
    Counted<float> sum[4] = {one, one, one, one}, pixel[3];
    convert_sum(sum);
    sum_over_background(sum, sum, pixel);
  });
}

// Fragments that are added, without reading the fragments themselves.
inline void charge_additions(std::uint64_t fragments, const Accumulator& accumulator, StageCounters& counters) {
  const std::uint64_t bytes = accumulator_bytes(accumulator.format);
  counters.items_in += fragments;
  counters.items_out += fragments;
  counters.ops += accumulation_cost(accumulator.double_counting == DoubleCounting::saturate) * fragments;
  counters.bytes_read += fragments * bytes;
  counters.bytes_written += fragments * bytes;
  counters.lanes_used += fragments;
  counters.lanes_issued += fragments;
}

inline void charge_accumulate(std::uint64_t fragments, const Accumulator& accumulator, StageCounters& counters) {
  counters.bytes_read += fragments * (kSampleFragmentBytes + kColorBytes);  // with the shader's colour
  charge_additions(fragments, accumulator, counters);
}

// The depth of each of the tile's `samples` is read and compared with the cleared depth. `pixels`: those that had a
// clear sample.
inline void charge_background(std::uint64_t samples, std::uint64_t pixels, const Accumulator& accumulator,
                              StageCounters& counters) {
  counters.bytes_read += samples * kSampleDepthBytes;
  counters.ops.add += samples;
  charge_additions(pixels, accumulator, counters);
}

// Each test reads the sample's stencil value and compares it; each sample that passes writes it.
inline void charge_stencil_test(std::uint64_t tested, std::uint64_t passed, StageCounters& counters) {
  constexpr std::uint64_t kStencilBytes = 1;  // per sample
  counters.items_in += tested;
  counters.items_out += passed;
  counters.ops.add += tested;
  counters.bytes_read += tested * kStencilBytes;
  counters.bytes_written += passed * kStencilBytes;
  counters.lanes_used += tested;
  counters.lanes_issued += tested;
}

}  // namespace beampipe
