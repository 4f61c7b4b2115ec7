#include "stages/temporal/temporal.h"

#include <algorithm>
#include <cmath>

#include "simd/scalar.h"
#include "stages/data/half_bits.h"
#include "stages/temporal/temporal_cost.h"
#include "stages/temporal/temporal_formulas.h"

namespace beampipe {
namespace {

glm::vec4 round_half(glm::vec4 color) {
  for (int c = 0; c < 4; ++c) color[c] = rounded_to_half(color[c]);
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

std::size_t nearest_texel(const Taps& taps) {
  return taps.texels[std::max_element(taps.weights, taps.weights + 4) - taps.weights];
}

// The part of the clamp that applies, 0..1.
float clamp_part(const CurrentFrame& frame, std::size_t pixel, const History& history, const Taps& taps,
                 const TemporalOptions& options) {
  if (options.clamp == Clamp::whole) return 1;
  if (options.clamp == Clamp::rest && history.looks[nearest_texel(taps)] != frame.looks[pixel]) return 1;
  if (frame.known[pixel] == 0) return 0;
  return options.clamp == Clamp::variance ? 1 : clamp_by_speed(frame.speeds[pixel], options.still_px);
}

}  // namespace

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
  charge_box(tile.pixels(), neighbors - tile.pixels(), counters);  // pixels do not count as their own neighbours
}

void temporal(const CurrentFrame& frame, const TemporalOptions& options, const History& history, const Tile& tile,
              StageCounters& counters, Accumulated& to) {
  const bool follows_deviation = options.clamp == Clamp::variance;
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
        to.color[i] = round_half(frame.color[i]);
        continue;
      }
      const Taps taps = taps_at(history, x, y);
      const float clamped = clamp_part(frame, i, history, taps, options), blend = options.blend * frame.known[i];
      glm::vec4 blended;
      for (int c = 0; c < 4; ++c) {
        float texels[4];
        for (int t = 0; t < 4; ++t) texels[t] = history.color[taps.texels[t]][c];
        const float old = filtered(texels, taps.weights), color = frame.color[i][c];
        ChannelBox<float> box{frame.low[i][c], frame.high[i][c]};
        if (follows_deviation) {
          const float deviation = history.deviation[nearest_texel(taps)][c];
          box = widened(box, deviation, options.deviations);
          to.deviation[i][c] = rounded_to_half(next_deviation(deviation, color - old, blend));
        }
        blended[c] = blend_channel(old, box, clamped, color, blend);
      }
      to.color[i] = round_half(blended);
      ++reused;
    }
  }
  charge_temporal(tile.pixels(), reused, options.clamp, counters);
}

}  // namespace beampipe
