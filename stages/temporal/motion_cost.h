// What motion and contents are charged.
#pragma once

#include "stages/cost/counting.h"
#include "stages/data/frame_history.h"
#include "stages/data/pixel_formats.h"
#include "stages/data/sample_tile.h"
#include "stages/temporal/motion.h"
#include "stages/temporal/temporal_formulas.h"

namespace beampipe {

// The movement of one point, without its conversion to fp16.
inline Movement<Counted<double>> counted_movement(OperationCounts& counts) {
  const Counted<double> one(1.0, counts);
  Reprojection<Counted<double>> to_last{{}, one, one};
  for (Counted<double>& element : to_last.m) element = one;
  return movement(to_last, one, one, one, one);
}

// Per pixel: its nearest sample, that sample's draw and the draw's matrix if there are ids, and the movement.
inline OperationCounts motion_cost(std::size_t samples, MotionFrom from) {
  return count_operations([&](OperationCounts& counts) {
    const Counted<double> one(1.0, counts);
    for (std::size_t s = 1; s < samples; ++s) select(one < one, one, one);
    const std::uint32_t table[1] = {};
    const Counted<std::int32_t> index(0, counts);
    if (from == MotionFrom::ids) fetch(table, index), fetch(table, index);
    const Movement<Counted<double>> moved = counted_movement(counts);
    converted(to_float(moved.dx)), converted(to_float(moved.dy));
  });
}

// Per pixel: the draws of its samples, each compared with all earlier ones, and the root of the largest square, to
// fp16.
inline OperationCounts contents_cost(std::size_t samples) {
  return count_operations([&](OperationCounts& counts) {
    const std::uint32_t table[1] = {};
    const Counted<std::int32_t> index(0, counts);
    for (std::size_t s = 0; s < samples; ++s) fetch(table, index);
    for (std::size_t pair = 0; pair < samples * (samples - 1) / 2; ++pair) static_cast<void>(index == index);
    converted(square_root(Counted<float>(1.0f, counts)));
  });
}

inline OperationCounts camera_speed_cost() {
  return count_operations([](OperationCounts& counts) {
    const Movement<Counted<double>> moved = counted_movement(counts);
    const Counted<float> x(converted(to_float(moved.dx))), y(converted(to_float(moved.dy)));
    converted(square_root(square_length(x, y)));
  });
}

// Per draw in a pixel: its look, its matrix, its movement, and the larger of two squares.
inline OperationCounts draw_cost() {
  return count_operations([](OperationCounts& counts) {
    const std::uint32_t table[1] = {};
    const Counted<std::int32_t> index(0, counts);
    fetch(table, index), fetch(table, index);
    const Counted<std::uint32_t> look(0, counts);
    look ^ look;
    const Movement<Counted<double>> moved = counted_movement(counts);
    const Counted<float> x(converted(to_float(moved.dx))), y(converted(to_float(moved.dy)));
    greater(x, square_length(x, y));
  });
}

// Of a triangle whose vertices have moved: its vertices in both frames, and the movement, beyond that of a draw that is
// not deformed.
inline OperationCounts deformed_cost() {
  return count_operations([](OperationCounts& counts) {
    const std::uint32_t table[1] = {};
    const Counted<std::int32_t> index(0, counts);
    for (int k = 0; k < 3; ++k) fetch(table, index);
    const Counted<double> one(1.0, counts);
    Counted<double> m[16];
    for (Counted<double>& element : m) element = one;
    ClipPoint<Counted<double>> corners[2][3];
    for (auto& frame : corners)
      for (auto& corner : frame) fetch(table, index), corner = in_clip(m, one, one, one);
    vertex_movement(corners[0], corners[1], one, one, one, one);
  });
}

// `triangles`: shown in pixels, of deformed draws.
inline void charge_deformed(std::uint64_t triangles, StageCounters& counters) {
  counters.ops += deformed_cost() * triangles;
  counters.bytes_read += kMovedTriangleBytes * triangles;
}

// `samples`: per pixel.
inline void charge_motion(std::uint64_t pixels, std::size_t samples, MotionFrom from, StageCounters& counters) {
  counters.items_in += pixels * samples;
  counters.items_out += pixels;
  counters.ops += motion_cost(samples, from) * pixels;
  counters.bytes_read += pixels * (samples * kSampleDepthBytes + (from == MotionFrom::ids ? kVisibilityBytes : 0));
  counters.bytes_written += pixels * kMotionBytes;
  counters.lanes_used += pixels;
  counters.lanes_issued += pixels;
}

// `draws`: in all pixels together. The depths of the samples are not read again.
inline void charge_contents(std::uint64_t pixels, std::size_t samples, std::uint64_t draws, StageCounters& counters) {
  counters.ops += contents_cost(samples) * pixels;
  counters.ops += draw_cost() * draws;
  counters.bytes_read += pixels * samples * kVisibilityBytes;
  counters.bytes_written += pixels * (kLookBytes + kSpeedBytes);
}

inline void charge_camera_speeds(std::uint64_t pixels, StageCounters& counters) {
  counters.ops += camera_speed_cost() * pixels;
  counters.bytes_written += pixels * kSpeedBytes;
}

}  // namespace beampipe
