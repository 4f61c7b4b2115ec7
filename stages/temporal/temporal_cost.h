// What temporal and neighborhood_box are charged.
#pragma once

#include "stages/cost/counting.h"
#include "stages/data/frame_history.h"
#include "stages/temporal/temporal.h"
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
inline OperationCounts reuse_cost(Clamp clamp) {
  return count_operations([&](OperationCounts& counts) {
    const Counted<float> one(1.0f, counts), four[4] = {one, one, one, one};
    Counted<float> weights[4];
    to_float(to_integer(one)), to_float(to_integer(one));  // the first texel
    texel_weights(one, one, one, one, weights);
    for (int value = 0; value < 4 * (4 + 2); ++value) converted(one);
    if (clamp == Clamp::rest || clamp == Clamp::variance)
      for (int tap = 1; tap < 4; ++tap) greater(one, one);  // the texel with the largest weight
    if (clamp == Clamp::rest || clamp == Clamp::camera) clamp_by_speed(converted(one), one);
    if (clamp != Clamp::whole) select(one > one, one, one);  // by whether anything is known
    if (clamp == Clamp::rest) select(one != one, one, one);  // by its look
    converted(one) * one;                                    // the blend factor times the known part
    for (int c = 0; c < 4; ++c) {
      const Counted<float> old = filtered(four, weights);
      if (clamp == Clamp::variance) {
        const Counted<float> deviation = converted(one);
        widened({one, one}, deviation, one);
        converted(next_deviation(deviation, one - old, one));
      }
      blend_channel(old, {one, one}, one, one, one);
    }
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

// `reused`: pixels that have a history.
inline void charge_temporal(std::uint64_t pixels, std::uint64_t reused, Clamp clamp, StageCounters& counters) {
  constexpr std::uint64_t kHistoryBytes = 8;  // fp16 RGBA
  counters.items_in += pixels;
  counters.items_out += pixels;
  counters.ops += temporal_pixel_cost() * pixels;
  counters.ops += reuse_cost(clamp) * reused;
  counters.bytes_read += pixels * (kCurrentColorBytes + kCurrentBoxBytes + kMotionBytes);
  counters.bytes_read += reused * 4 * kHistoryBytes;
  if (clamp == Clamp::rest || clamp == Clamp::camera) counters.bytes_read += pixels * kSpeedBytes;
  if (clamp == Clamp::rest) counters.bytes_read += (pixels + reused) * kLookBytes;
  if (clamp == Clamp::variance) counters.bytes_read += reused * kDeviationBytes;
  counters.bytes_written += pixels * (kHistoryBytes + (clamp == Clamp::variance ? kDeviationBytes : 0));
  counters.lanes_used += reused;
  counters.lanes_issued += pixels;
}

}  // namespace beampipe
