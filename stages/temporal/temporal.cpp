#include "stages/temporal/temporal.h"

#include <algorithm>
#include <cmath>

#include "simd/scalar.h"
#include "stages/cost/counting.h"
#include "stages/data/half_bits.h"

namespace beampipe {
namespace {

constexpr std::uint64_t kHistoryBytes = 8;  // fp16 RGBA

// One channel: four texels weighted, clamped by as much as `clamped` says, blended with the new colour.
template <class Real>
Real blend_channel(const Real texels[4], const Real weights[4], Real low, Real high, Real clamped, Real color,
                   Real blend) {
  const Real old = texels[0] * weights[0] + texels[1] * weights[1] + texels[2] * weights[2] + texels[3] * weights[3];
  const Real in_box = greater(low, lesser(high, old));
  const Real kept = old + (in_box - old) * clamped;
  return kept + (color - kept) * blend;
}

// Bilinear weights of the four texels around (x, y), of which (left, top) is the first; all in texels.
template <class Real>
void texel_weights(Real x, Real y, Real left, Real top, Real weights[4]) {
  const Real one(1.0f), half(0.5f);
  const Real fx = x - half - left, fy = y - half - top, rest_x = one - fx, rest_y = one - fy;
  weights[0] = rest_x * rest_y, weights[1] = fx * rest_y, weights[2] = rest_x * fy, weights[3] = fx * fy;
}

// How much of the clamp is in force: the speed over that from which it is whole.
template <class Real>
Real clamp_part(Real speed, Real still_px) {
  return lesser(speed / still_px, Real(1.0f));
}

using CountedReal = Counted<float>;

// Of every pixel: where it was, and whether that is on the screen; the colour from fp16 and back.
OperationCounts pixel_cost() {
  return count_operations([&](OperationCounts& counts) {
    const CountedReal one(1.0f, counts);
    for (int axis = 0; axis < 2; ++axis) {
      const CountedReal at = one + converted(one);
      static_cast<void>(at >= one), static_cast<void>(at <= one);
    }
    for (int c = 0; c < 4; ++c) converted(converted(one));
  });
}

// Of a pixel that has a history: its texels and its box, from fp16, and what is made of them.
OperationCounts reuse_cost(bool fading) {
  return count_operations([&](OperationCounts& counts) {
    const CountedReal one(1.0f, counts), four[4] = {one, one, one, one};
    CountedReal weights[4];
    to_float(to_integer(one)), to_float(to_integer(one));  // the first texel
    texel_weights(one, one, one, one, weights);
    for (int value = 0; value < 4 * (4 + 2); ++value) converted(one);
    if (fading) {
      for (int tap = 1; tap < 4; ++tap) greater(one, one);  // the texel that weighs the most
      const CountedReal fading_in = clamp_part(converted(one), one);
      select(one != one, one, select(one > one, fading_in, one));  // by its look, and by whether anything is known
    }
    converted(one) * one;  // the blend by what is known
    for (int c = 0; c < 4; ++c) blend_channel(four, weights, one, one, one, one, one);
  });
}

// Of a neighbour: least and greatest, four channels from fp16.
OperationCounts neighbor_cost() {
  return count_operations([](OperationCounts& counts) {
    const CountedReal one(1.0f, counts);
    for (int c = 0; c < 4; ++c) {
      const CountedReal color = converted(one);
      lesser(one, color), greater(one, color);
    }
  });
}

glm::vec4 round_half(glm::vec4 color) {
  for (int c = 0; c < 4; ++c) color[c] = HalfBits(color[c]);
  return color;
}

// The history's four texels around a position, and their bilinear weights.
struct Taps {
  std::size_t texels[4];
  float weights[4];
};

Taps taps_at(const History& history, float x, float y) {
  const float left = std::floor(x - 0.5f), top = std::floor(y - 0.5f);
  Taps taps;
  texel_weights(x, y, left, top, taps.weights);
  for (int i = 0; i < 4; ++i) {
    const auto column = std::clamp(static_cast<std::int32_t>(left) + i % 2, 0, history.width - 1);
    const auto row = std::clamp(static_cast<std::int32_t>(top) + i / 2, 0, history.height - 1);
    taps.texels[i] = static_cast<std::size_t>(row * history.width + column);
  }
  return taps;
}

float clamp_part(const CurrentFrame& frame, std::size_t pixel, const History& history, const Taps& taps,
                 float still_px) {
  if (still_px == 0) return 1;
  const auto nearest = std::max_element(taps.weights, taps.weights + 4) - taps.weights;
  if (history.looks[taps.texels[nearest]] != frame.looks[pixel]) return 1;
  return frame.known[pixel] > 0 ? clamp_part(frame.speeds[pixel], still_px) : 0;  // else no box
}

}  // namespace

CurrentFrame::CurrentFrame(std::uint32_t frame_width, std::uint32_t frame_height)
    : width(static_cast<std::int32_t>(frame_width)), height(static_cast<std::int32_t>(frame_height)) {
  const std::size_t pixels = std::size_t{frame_width} * frame_height;
  color.resize(pixels), low.resize(pixels), high.resize(pixels), motion.resize(pixels);
  looks.resize(pixels), speeds.resize(pixels);
  known.assign(pixels, 1.0f);
}

void neighborhood_box(const Tile& tile, StageCounters& counters, CurrentFrame& frame) {
  std::uint64_t neighbors = 0;
  for (std::int32_t y = tile.y0; y < tile.y1; ++y) {
    for (std::int32_t x = tile.x0; x < tile.x1; ++x) {
      const auto at = static_cast<std::size_t>(y * frame.width + x);
      glm::vec4 low = frame.color[at], high = low;
      for (std::int32_t ny = std::max(y - 1, 0); ny <= std::min(y + 1, frame.height - 1); ++ny) {
        for (std::int32_t nx = std::max(x - 1, 0); nx <= std::min(x + 1, frame.width - 1); ++nx) {
          const glm::vec4& color = frame.color[static_cast<std::size_t>(ny * frame.width + nx)];
          ++neighbors;
          low = glm::min(low, color), high = glm::max(high, color);
        }
      }
      frame.low[at] = low, frame.high[at] = high;
    }
  }
  neighbors -= tile.pixels();  // which are none of their own
  counters.ops += neighbor_cost() * neighbors;
  counters.ops.convert += (4 + 2 * 4) * tile.pixels();  // its own colour, from fp16; its box, into it
  counters.bytes_read += (neighbors + tile.pixels()) * kCurrentColorBytes;
  counters.bytes_written += tile.pixels() * kCurrentBoxBytes;
}

void temporal(const CurrentFrame& frame, const TemporalOptions& options, const History& history, const Tile& tile,
              StageCounters& counters, std::vector<glm::vec4>& image) {
  const bool has_history = history.frames > 0 && history.width == frame.width && history.height == frame.height;
  std::uint64_t reused = 0;
  for (std::int32_t row = tile.y0; row < tile.y1; ++row) {
    for (std::int32_t column = tile.x0; column < tile.x1; ++column) {
      const auto i = static_cast<std::size_t>(row * frame.width + column);
      const glm::vec2 motion = frame.motion[i];
      const float x = static_cast<float>(column) + 0.5f + motion.x, y = static_cast<float>(row) + 0.5f + motion.y;
      const bool on_screen =
          x >= 0 && x <= static_cast<float>(frame.width) && y >= 0 && y <= static_cast<float>(frame.height);
      if (!has_history || !on_screen) {
        image[i] = round_half(frame.color[i]);
        continue;
      }
      const Taps taps = taps_at(history, x, y);
      const float clamped = clamp_part(frame, i, history, taps, options.still_px);
      glm::vec4 blended;
      for (int c = 0; c < 4; ++c) {
        float texels[4];
        for (int t = 0; t < 4; ++t) texels[t] = history.color[taps.texels[t]][c];
        blended[c] = blend_channel(texels, taps.weights, frame.low[i][c], frame.high[i][c], clamped, frame.color[i][c],
                                   options.blend * frame.known[i]);
      }
      image[i] = round_half(blended);
      ++reused;
    }
  }

  const std::size_t pixels = tile.pixels();
  counters.items_in += pixels;
  counters.items_out += pixels;
  const bool fading = options.still_px > 0;
  counters.ops += pixel_cost() * pixels;
  counters.ops += reuse_cost(fading) * reused;
  counters.bytes_read += pixels * (kCurrentColorBytes + kCurrentBoxBytes + kMotionBytes);
  counters.bytes_read += reused * 4 * kHistoryBytes;
  if (fading) counters.bytes_read += pixels * (kLookBytes + kSpeedBytes) + reused * kLookBytes;
  counters.bytes_written += pixels * kHistoryBytes;
  counters.lanes_used += reused;
  counters.lanes_issued += pixels;
}

}  // namespace beampipe
