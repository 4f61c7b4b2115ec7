// What dilate is charged.
#pragma once

#include "stages/cost/counting.h"
#include "stages/data/frame_history.h"
#include "stages/data/pixel_formats.h"
#include "stages/samples/sample_formulas.h"

namespace beampipe {

inline OperationCounts dilated_pixel_cost() {
  return count_operations([](OperationCounts& counts) {
    const Counted<std::uint32_t> bits(1, counts), masks[4] = {bits, bits, bits, bits};
    const Counted<float> one(1.0f, counts), values[4] = {one, one, one, one};
    Counted<float> weights[4];
    const Counted<float> inverse = one / weigh(masks, bits, weights);
    for (int channel = 0; channel < 3 * 4; ++channel)
      converted(weighted_mean(values, weights, inverse));          // colour, low, high
    for (int channel = 0; channel < 3; ++channel) converted(one);  // its own sample, from fp16
  });
}

// Per neighbour of a shading sample.
inline OperationCounts dilated_neighbor_cost() {
  return count_operations([](OperationCounts& counts) {
    const Counted<float> one(1.0f, counts), id(0.0f, counts);
    Counted<float> color[4] = {converted(one), converted(one), converted(one), one}, low[4] = {one, one, one, one},
                   high[4] = {one, one, one, one};
    grow_box(color, id == id, low, high);
  });
}

// `known`: pixels with at least one visibility sample that has a colour; `neighbors`: of all shading samples.
inline void charge_dilate(std::uint64_t pixels, std::uint64_t known, std::uint64_t neighbors, StageCounters& counters) {
  constexpr std::uint64_t kSampleBytes = kColorBytes + kVisibilityBytes;
  counters.items_in += pixels;
  counters.items_out += pixels;
  counters.ops += dilated_pixel_cost() * pixels;
  counters.ops += dilated_neighbor_cost() * neighbors;
  // A pixel reads its own sample and mask. Those of its quad come by exchange between lanes.
  counters.bytes_read += pixels * (kSampleBytes + 4) + neighbors * kSampleBytes;
  counters.bytes_written += pixels * (kCurrentColorBytes + kCurrentBoxBytes);
  counters.lanes_used += known;
  counters.lanes_issued += pixels;
}

}  // namespace beampipe
