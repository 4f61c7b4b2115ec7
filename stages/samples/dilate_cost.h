// What dilate is charged.
#pragma once

#include <vector>

#include "stages/cost/counting.h"
#include "stages/data/frame_history.h"
#include "stages/data/pixel_formats.h"
#include "stages/data/sample_quad.h"
#include "stages/samples/sample_formulas.h"

namespace beampipe {

// How often each operation was done.
struct DilateWork {
  std::uint64_t extras = 0, ends = 0;                // extra shading samples; quads with room for more
  std::uint64_t pixels_with[kQuadSamples + 1] = {};  // by the number of shading samples in their quad
  std::uint64_t known = 0;                           // pixels with at least one visibility sample that has a colour
  std::uint64_t neighbors = 0;                       // of all shading samples
};

// `samples`: of the quad.
inline OperationCounts dilated_pixel_cost(int samples) {
  return count_operations([&](OperationCounts& counts) {
    const Counted<std::uint32_t> bits(1, counts);
    const Counted<float> one(1.0f, counts);
    const std::vector<Counted<std::uint32_t>> masks(kQuadSamples, bits);
    const std::vector<Counted<float>> values(kQuadSamples, one);
    Counted<float> weights[kQuadSamples];
    const Counted<float> inverse = one / weigh(masks.data(), samples, bits, weights);
    for (int channel = 0; channel < 3 * 4; ++channel)
      converted(weighted_mean(values.data(), weights, samples, inverse));  // colour, low, high
    for (int channel = 0; channel < 3; ++channel) converted(one);          // its own sample, from fp16
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

inline void charge_dilate(const DilateWork& work, StageCounters& counters) {
  constexpr std::uint64_t kSampleBytes = kColorBytes + kVisibilityBytes;
  std::uint64_t pixels = 0;
  for (int samples = 4; samples <= static_cast<int>(kQuadSamples); ++samples) {
    const std::uint64_t of_these = work.pixels_with[samples];
    if (of_these > 0) counters.ops += dilated_pixel_cost(samples) * of_these;
    pixels += of_these;
  }
  counters.items_in += pixels;
  counters.items_out += pixels;
  counters.ops += dilated_neighbor_cost() * work.neighbors;
  counters.ops.convert += 3 * work.extras;  // colours from fp16
  // A pixel reads its own sample and mask. Those of its quad come by exchange between lanes, extra ones too.
  counters.bytes_read += (pixels + work.extras) * (kSampleBytes + 4) + work.neighbors * kSampleBytes;
  counters.bytes_read += work.ends * kEndOfExtrasBytes;
  counters.bytes_written += pixels * (kCurrentColorBytes + kCurrentBoxBytes);
  counters.lanes_used += work.known;
  counters.lanes_issued += pixels;
}

}  // namespace beampipe
