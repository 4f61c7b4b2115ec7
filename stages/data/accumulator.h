// The colour accumulator of ACAA (Enderton et al. 2015): the weighted sum of the visible fragments of each pixel.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "stages/data/half_bits.h"
#include "stages/data/pixel_observer.h"
#include "stages/data/tile.h"

namespace beampipe {

enum class AccumulatorFormat { unorm8, fp16, fp32 };  // of each of four channels; every sum is rounded to it

constexpr std::uint32_t accumulator_bytes(AccumulatorFormat format) {
  return format == AccumulatorFormat::unorm8 ? 4 : format == AccumulatorFormat::fp16 ? 8 : 16;
}

inline float rounded_to(AccumulatorFormat format, float value) {
  switch (format) {
    case AccumulatorFormat::unorm8:
      return std::floor(std::clamp(value, 0.0f, 1.0f) * 255.0f + 0.5f) / 255.0f;
    case AccumulatorFormat::fp16:
      return rounded_to_half(value);
    default:
      return value;
  }
}

// If two fragments have the same depth at a sample, both pass the depth test. What happens to the second:
enum class DoubleCounting {
  none,      // it is added as well
  stencil,   // a stencil value per sample lets only the first one pass
  saturate,  // saturated alpha blending: alpha sums up the shares, and a fragment adds at most what is missing to
             // `limit`
};

struct Accumulator {
  AccumulatorFormat format;
  DoubleCounting double_counting;
  float sample_share;             // of the pixel: 1 / samples of all passes
  float limit = 1;                // the most that alpha may reach so far: the share of the samples that were looked at
  std::vector<glm::vec4> color;   // one per pixel of the tile; alpha: the sum of the shares so far
  std::vector<float> background;  // the background's share; the image's A needs it, but it is not stored in hardware
  std::vector<std::uint32_t> taken;  // stencil: the samples at which a fragment has passed since the last clear
  const PixelObservers* observers = nullptr;  // who looks at the pixels; null: nobody

  Accumulator(const Tile& tile, int samples, AccumulatorFormat accumulator_format, DoubleCounting counting)
      : format(accumulator_format),
        double_counting(counting),
        sample_share(1.0f / static_cast<float>(samples)),
        color(tile.pixels(), glm::vec4(0.0f)),
        background(tile.pixels(), 0.0f),
        taken(tile.pixels(), 0) {}
};

}  // namespace beampipe
