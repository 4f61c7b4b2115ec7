#include "stages/temporal.h"

#include <half.h>

#include <algorithm>
#include <cmath>

#include "simd/scalar.h"
#include "stages/counting.h"
#include "stages/depth_test.h"

namespace beampipe {
namespace {

constexpr std::uint64_t kColorBytes = 8;  // fp16 RGBA

// Screen position in the previous frame, in pixels, of a pixel's (x, y) in normalized device coordinates and depth.
// `m`: clip space of this frame to that of the previous one, column-major.
template <class Real>
void reproject(const Real m[16], Real x, Real y, Real z, Real width, Real height, Real& previous_x, Real& previous_y,
               Real& w) {
  const auto row = [&](int r) { return m[r] * x + m[4 + r] * y + m[8 + r] * z + m[12 + r]; };
  const Real one(1.0f), half(0.5f);
  w = row(3);
  const Real inverse = one / w;
  previous_x = (row(0) * inverse + one) * half * width;
  previous_y = (one - row(1) * inverse) * half * height;
}

// One channel: four texels weighted, clamped by as much as `clamped` says, blended with the new colour.
template <class Real>
Real blend_channel(const Real texels[4], const Real weights[4], Real low, Real high, Real clamped, Real color,
                   Real blend) {
  const Real old = texels[0] * weights[0] + texels[1] * weights[1] + texels[2] * weights[2] + texels[3] * weights[3];
  const Real in_box = greater(low, lesser(high, old));
  const Real kept = old + (in_box - old) * clamped;
  return kept + (color - kept) * blend;
}

OperationCounts pixel_cost() {
  return count_operations([](OperationCounts& counts) {
    const Counted<float> one(1.0f, counts), four[4] = {one, one, one, one};
    Counted<float> m[16], x, y, w;
    for (Counted<float>& element : m) element = one;
    reproject(m, one, one, one, one, one, x, y, w);
    for (int c = 0; c < 4; ++c) blend_channel(four, four, one, one, one, one, one);
    counts += OperationCounts{4, 4, 0, 0, 0, 2};              // the texels' weights from the position
    counts += OperationCounts{3, 2, 0, 0, 1, 4 * 4 + 4 + 4};  // length of the motion; colours from and to fp16
  });
}

glm::vec4 round_half(glm::vec4 color) {
  for (int c = 0; c < 4; ++c) color[c] = half(std::min(color[c], static_cast<float>(HALF_MAX)));
  return color;
}

// The history's four texels around a position, and their bilinear weights.
struct Taps {
  const glm::vec4* texels[4];
  float weights[4];
};

Taps taps_at(const History& history, double x, double y) {
  const double left = std::floor(x - 0.5), top = std::floor(y - 0.5);
  const auto fx = static_cast<float>(x - 0.5 - left), fy = static_cast<float>(y - 0.5 - top);
  Taps taps{{}, {(1 - fx) * (1 - fy), fx * (1 - fy), (1 - fx) * fy, fx * fy}};
  for (int i = 0; i < 4; ++i) {
    const auto column = std::clamp(static_cast<std::int32_t>(left) + i % 2, 0, history.width - 1);
    const auto row = std::clamp(static_cast<std::int32_t>(top) + i / 2, 0, history.height - 1);
    taps.texels[i] = &history.color[static_cast<std::size_t>(row * history.width + column)];
  }
  return taps;
}

}  // namespace

CurrentFrame::CurrentFrame(std::uint32_t frame_width, std::uint32_t frame_height)
    : width(static_cast<std::int32_t>(frame_width)), height(static_cast<std::int32_t>(frame_height)) {
  const std::size_t pixels = std::size_t{frame_width} * frame_height;
  color.resize(pixels), low.resize(pixels), high.resize(pixels);
  known.assign(pixels, 1.0f);
  depth.assign(pixels, kFarDepth);
}

void neighborhood_box(CurrentFrame& frame, StageCounters& counters) {
  std::size_t at = 0;
  for (std::int32_t y = 0; y < frame.height; ++y) {
    for (std::int32_t x = 0; x < frame.width; ++x, ++at) {
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
  counters.ops.add += at * 2 * 8 * 4;  // minima and maxima with eight neighbours, four channels
  counters.bytes_read += at * 8 * kColorBytes;
}

std::vector<glm::vec4> temporal(const CurrentFrame& frame, const TemporalOptions& options, StageCounters& counters,
                                History& history) {
  const std::size_t pixels = frame.color.size();
  const bool has_history = history.frames > 0 && history.width == frame.width && history.height == frame.height;
  const glm::dmat4 to_previous = history.view_projection * glm::inverse(frame.view_projection);
  double m[16];
  for (int i = 0; i < 16; ++i) m[i] = to_previous[i / 4][i % 4];
  std::vector<glm::vec4> image(pixels);
  std::uint64_t reused = 0;
  for (std::size_t i = 0; i < pixels; ++i) {
    const auto column = static_cast<std::int32_t>(i) % frame.width, row = static_cast<std::int32_t>(i) / frame.width;
    const double center_x = column + 0.5, center_y = row + 0.5;
    const double far = 1.0, z = frame.depth[i] >= 0 ? far : 2.0 * double{frame.depth[i]} + 1.0;
    double x = 0, y = 0, w = 0;
    reproject<double>(m, 2 * center_x / frame.width - 1, 1 - 2 * center_y / frame.height, z, frame.width, frame.height,
                      x, y, w);
    const bool on_screen = w > 0 && x >= 0 && x <= frame.width && y >= 0 && y <= frame.height;
    if (!has_history || !on_screen) {
      image[i] = round_half(frame.color[i]);
      continue;
    }
    const double motion = std::hypot(x - center_x, y - center_y);
    const float known = frame.known[i];
    float clamped = options.still_px > 0 ? static_cast<float>(std::min(motion / options.still_px, 1.0)) : 1.0f;
    if (known == 0) clamped = 0;  // there is no box
    const Taps taps = taps_at(history, x, y);
    for (int c = 0; c < 4; ++c) {
      float texels[4];
      for (int t = 0; t < 4; ++t) texels[t] = (*taps.texels[t])[c];
      image[i][c] = blend_channel(texels, taps.weights, frame.low[i][c], frame.high[i][c], clamped, frame.color[i][c],
                                  options.blend * known);
    }
    image[i] = round_half(image[i]);
    ++reused;
  }
  history = {history.frames + 1, frame.width, frame.height, image, frame.view_projection};

  counters.items_in += pixels;
  counters.items_out += pixels;
  counters.ops += pixel_cost() * pixels;
  counters.bytes_read += pixels * (kColorBytes + kSampleDepthBytes) + reused * 4 * kColorBytes;
  counters.bytes_written += pixels * kColorBytes;
  counters.lanes_used += reused;
  counters.lanes_issued += pixels;
  return image;
}

}  // namespace beampipe
