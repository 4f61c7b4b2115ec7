#include "stages/temporal.h"

#include <algorithm>
#include <cmath>

#include "simd/scalar.h"
#include "stages/counting.h"
#include "stages/half_bits.h"

namespace beampipe {
namespace {

constexpr std::uint64_t kColorBytes = 8;  // fp16 RGBA

// One channel: four texels weighted, clamped by as much as `clamped` says, blended with the new colour.
template <class Real>
Real blend_channel(const Real texels[4], const Real weights[4], Real low, Real high, Real clamped, Real color,
                   Real blend) {
  const Real old = texels[0] * weights[0] + texels[1] * weights[1] + texels[2] * weights[2] + texels[3] * weights[3];
  const Real in_box = greater(low, lesser(high, old));
  const Real kept = old + (in_box - old) * clamped;
  return kept + (color - kept) * blend;
}

OperationCounts pixel_cost(bool fading) {
  return count_operations([&](OperationCounts& counts) {
    const Counted<float> one(1.0f, counts), four[4] = {one, one, one, one};
    for (int c = 0; c < 4; ++c) blend_channel(four, four, one, one, one, one, one);
    counts += OperationCounts{4, 4, 0, 0, 0, 2};          // the texels' weights from the position
    counts += OperationCounts{0, 0, 0, 0, 0, 6 * 4 + 2};  // six colours and the motion from and to fp16
    if (fading) counts += OperationCounts{5 * 2 + 1, 5 * 2, 0, 0, 1, 4 * 2};  // the greatest of five motions
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
  const float fx = x - 0.5f - left, fy = y - 0.5f - top;
  Taps taps{{}, {(1 - fx) * (1 - fy), fx * (1 - fy), (1 - fx) * fy, fx * fy}};
  for (int i = 0; i < 4; ++i) {
    const auto column = std::clamp(static_cast<std::int32_t>(left) + i % 2, 0, history.width - 1);
    const auto row = std::clamp(static_cast<std::int32_t>(top) + i / 2, 0, history.height - 1);
    taps.texels[i] = static_cast<std::size_t>(row * history.width + column);
  }
  return taps;
}

// How much of the clamp is in force.
float clamp_part(const glm::vec2& motion, const History& history, const Taps& taps, float still_px) {
  if (still_px == 0) return 1;
  float square = glm::dot(motion, motion);
  for (const std::size_t texel : taps.texels)
    square = std::max(square, glm::dot(history.motion[texel], history.motion[texel]));
  return std::min(std::sqrt(square) / still_px, 1.0f);
}

}  // namespace

CurrentFrame::CurrentFrame(std::uint32_t frame_width, std::uint32_t frame_height)
    : width(static_cast<std::int32_t>(frame_width)), height(static_cast<std::int32_t>(frame_height)) {
  const std::size_t pixels = std::size_t{frame_width} * frame_height;
  color.resize(pixels), low.resize(pixels), high.resize(pixels), motion.resize(pixels);
  known.assign(pixels, 1.0f);
}

void neighborhood_box(const Tile& tile, StageCounters& counters, CurrentFrame& frame) {
  for (std::int32_t y = tile.y0; y < tile.y1; ++y) {
    for (std::int32_t x = tile.x0; x < tile.x1; ++x) {
      const auto at = static_cast<std::size_t>(y * frame.width + x);
      glm::vec4 low = frame.color[at], high = low;
      for (std::int32_t ny = std::max(y - 1, 0); ny <= std::min(y + 1, frame.height - 1); ++ny) {
        for (std::int32_t nx = std::max(x - 1, 0); nx <= std::min(x + 1, frame.width - 1); ++nx) {
          const glm::vec4& color = frame.color[static_cast<std::size_t>(ny * frame.width + nx)];
          low = glm::min(low, color), high = glm::max(high, color);
        }
      }
      frame.low[at] = low, frame.high[at] = high;
    }
  }
  counters.ops.add += tile.pixels() * 2 * 8 * 4;  // minima and maxima with eight neighbours, four channels
  counters.bytes_read += tile.pixels() * 8 * kColorBytes;
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
      const float known = frame.known[i];
      const Taps taps = taps_at(history, x, y);
      const float clamped = known > 0 ? clamp_part(motion, history, taps, options.still_px) : 0;  // else no box
      glm::vec4 blended;
      for (int c = 0; c < 4; ++c) {
        float texels[4];
        for (int t = 0; t < 4; ++t) texels[t] = history.color[taps.texels[t]][c];
        blended[c] = blend_channel(texels, taps.weights, frame.low[i][c], frame.high[i][c], clamped, frame.color[i][c],
                                   options.blend * known);
      }
      image[i] = round_half(blended);
      ++reused;
    }
  }

  const std::size_t pixels = tile.pixels();
  counters.items_in += pixels;
  counters.items_out += pixels;
  const bool fading = options.still_px > 0;
  counters.ops += pixel_cost(fading) * pixels;
  counters.bytes_read += pixels * (kColorBytes + kMotionBytes);
  counters.bytes_read += reused * 4 * (kColorBytes + (fading ? kMotionBytes : 0));
  counters.bytes_written += pixels * kColorBytes;
  counters.lanes_used += reused;
  counters.lanes_issued += pixels;
}

}  // namespace beampipe
