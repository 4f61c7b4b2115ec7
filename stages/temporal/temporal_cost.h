// What temporal and neighborhood_box are charged.
#pragma once

#include "stages/cost/counting.h"
#include "stages/data/frame_history.h"
#include "stages/temporal/temporal_formulas.h"

namespace beampipe {

// Per pixel: where it was and whether that is on the screen; its colour is converted from fp16 and back.
inline OperationCounts temporal_pixel_cost() {
  return count_operations([&](OperationCounts& counts) {
    const Counted<float> one(1.0f, counts);
    for (int axis = 0; axis < 2; ++axis) {
      const Counted<float> at = one + converted(one);
      static_cast<void>(at >= one), static_cast<void>(at <= one);
    }
    for (int c = 0; c < 4; ++c) converted(converted(one));
  });
}

// Per pixel that has a history: its texels and its box are converted from fp16, and the result is computed.
inline OperationCounts reuse_cost(bool fading) {
  return count_operations([&](OperationCounts& counts) {
    const Counted<float> one(1.0f, counts), four[4] = {one, one, one, one};
    Counted<float> weights[4];
    to_float(to_integer(one)), to_float(to_integer(one));  // the first texel
    texel_weights(one, one, one, one, weights);
    for (int value = 0; value < 4 * (4 + 2); ++value) converted(one);
    if (fading) {
      for (int tap = 1; tap < 4; ++tap) greater(one, one);  // the texel with the largest weight
      const Counted<float> part = clamp_by_speed(converted(one), one);
      select(one != one, one, select(one > one, part, one));  // by its look, and by whether anything is known
    }
    converted(one) * one;  // the blend factor times the known part
    for (int c = 0; c < 4; ++c) blend_channel(four, weights, {one, one}, one, one, one);
  });
}

// Per neighbour: the minimum and maximum of four channels, from fp16.
inline OperationCounts box_neighbor_cost() {
  return count_operations([](OperationCounts& counts) {
    const Counted<float> one(1.0f, counts);
    for (int c = 0; c < 4; ++c) {
      const Counted<float> color = converted(one);
      lesser(one, color), greater(one, color);
    }
  });
}

// `neighbors`: of all pixels together, without the pixels themselves. A pixel's own colour is converted from fp16 and
// its box is converted to fp16.
inline void charge_box(std::uint64_t pixels, std::uint64_t neighbors, StageCounters& counters) {
  counters.ops += box_neighbor_cost() * neighbors;
  counters.ops.convert += (4 + 2 * 4) * pixels;
  counters.bytes_read += (neighbors + pixels) * kCurrentColorBytes;
  counters.bytes_written += pixels * kCurrentBoxBytes;
}

// `reused`: pixels that have a history; `fading`: still_px is not 0.
inline void charge_temporal(std::uint64_t pixels, std::uint64_t reused, bool fading, StageCounters& counters) {
  constexpr std::uint64_t kHistoryBytes = 8;  // fp16 RGBA
  counters.items_in += pixels;
  counters.items_out += pixels;
  counters.ops += temporal_pixel_cost() * pixels;
  counters.ops += reuse_cost(fading) * reused;
  counters.bytes_read += pixels * (kCurrentColorBytes + kCurrentBoxBytes + kMotionBytes);
  counters.bytes_read += reused * 4 * kHistoryBytes;
  if (fading) counters.bytes_read += pixels * (kLookBytes + kSpeedBytes) + reused * kLookBytes;
  counters.bytes_written += pixels * kHistoryBytes;
  counters.lanes_used += reused;
  counters.lanes_issued += pixels;
}

}  // namespace beampipe
