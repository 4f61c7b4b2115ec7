#include "stages/dilate.h"

#include <algorithm>
#include <bit>

#include "simd/scalar.h"
#include "stages/counting.h"

namespace beampipe {
namespace {

constexpr std::uint64_t kColorBytes = 6;  // fp16 RGB

// A shading sample, ready for its pixels.
struct Shaded {
  std::uint32_t draw;
  glm::vec4 color, low, high;
};

// The four weights of a pixel, and their sum: `base` has the pixel's bits.
template <class Bits, class Real>
Real weigh(const Bits masks[4], Bits base, Real weights[4]) {
  for (int i = 0; i < 4; ++i) weights[i] = bit_count(masks[i] & base);
  return weights[0] + weights[1] + weights[2] + weights[3];
}

template <class Real>
Real mean(const Real values[4], const Real weights[4], Real inverse) {
  return (values[0] * weights[0] + values[1] * weights[1] + values[2] * weights[2] + values[3] * weights[3]) * inverse;
}

OperationCounts pixel_cost() {
  return count_operations([](OperationCounts& counts) {
    const Counted<std::uint32_t> bits(1, counts), masks[4] = {bits, bits, bits, bits};
    const Counted<float> one(1.0f, counts), values[4] = {one, one, one, one};
    Counted<float> weights[4];
    const Counted<float> inverse = one / weigh(masks, bits, weights);
    for (int channel = 0; channel < 3 * 4; ++channel) mean(values, weights, inverse);  // colour, low, high
    counts.add += 2 * 8 * 4 + 8;  // the box: minima, maxima and comparisons of the draws with eight neighbours
    counts.convert += 4 * 3;
  });
}

// Shading samples where they are stored: two per quad in x and in y.
std::vector<Shaded> shade_samples(const QuadFrame& quads, const std::vector<glm::vec3>& colors,
                                  const std::vector<std::uint32_t>& draws, const glm::vec3& background) {
  std::vector<Shaded> samples(4 * quads.quads.size());
  for (std::size_t q = 0; q < quads.quads.size(); ++q) {
    for (std::size_t p = 0; p < 4; ++p) {
      const std::uint32_t triangle = quads.quads[q].triangle[p];
      const std::size_t x = 2 * (q % static_cast<std::size_t>(quads.columns)) + p % 2;
      const std::size_t y = 2 * (q / static_cast<std::size_t>(quads.columns)) + p / 2;
      Shaded& sample = samples[y * 2 * static_cast<std::size_t>(quads.columns) + x];
      sample.draw = triangle == kNoTriangle ? kNoTriangle : draws[triangle];
      sample.color = triangle == kNoTriangle ? glm::vec4(background, 0.0f) : glm::vec4(colors[triangle], 1.0f);
    }
  }
  return samples;
}

// Neighbours inside the frame only: samples outside it were never shaded.
void find_boxes(const CurrentFrame& frame, std::int32_t stride, std::vector<Shaded>& samples) {
  for (std::int32_t y = 0; y < frame.height; ++y) {
    for (std::int32_t x = 0; x < frame.width; ++x) {
      Shaded& sample = samples[static_cast<std::size_t>(y * stride + x)];
      sample.low = sample.high = sample.color;
      for (std::int32_t ny = std::max(y - 1, 0); ny <= std::min(y + 1, frame.height - 1); ++ny) {
        for (std::int32_t nx = std::max(x - 1, 0); nx <= std::min(x + 1, frame.width - 1); ++nx) {
          const Shaded& other = samples[static_cast<std::size_t>(ny * stride + nx)];
          if (other.draw != sample.draw) continue;
          sample.low = glm::min(sample.low, other.color), sample.high = glm::max(sample.high, other.color);
        }
      }
    }
  }
}

}  // namespace

QuadFrame::QuadFrame(std::uint32_t width, std::uint32_t height)
    : columns(static_cast<std::int32_t>((width + 1) / 2)),
      rows(static_cast<std::int32_t>((height + 1) / 2)),
      quads(static_cast<std::size_t>(columns * rows)) {}

void QuadFrame::insert(const Tile& tile, const std::vector<SampleQuad>& of_tile) {
  const std::int32_t width = (tile.width() + 1) / 2;
  for (std::size_t i = 0; i < of_tile.size(); ++i) {
    const auto x = tile.x0 / 2 + static_cast<std::int32_t>(i) % width,
               y = tile.y0 / 2 + static_cast<std::int32_t>(i) / width;
    quads[static_cast<std::size_t>(y * columns + x)] = of_tile[i];
  }
}

void dilate(const QuadFrame& quads, const std::vector<glm::vec3>& colors, const std::vector<std::uint32_t>& draws,
            const glm::vec3& background, StageCounters& counters, CurrentFrame& frame) {
  const std::int32_t stride = 2 * quads.columns;
  std::vector<Shaded> samples = shade_samples(quads, colors, draws, background);
  find_boxes(frame, stride, samples);
  std::uint64_t known = 0;
  for (std::int32_t y = 0; y < frame.height; ++y) {
    for (std::int32_t x = 0; x < frame.width; ++x) {
      const SampleQuad& quad = quads.quads[static_cast<std::size_t>(y / 2 * quads.columns + x / 2)];
      const auto i = static_cast<std::size_t>(y * frame.width + x);
      float weights[4];
      const float marked = weigh(quad.mask, 0xffu << 8 * (y % 2 * 2 + x % 2), weights);
      frame.known[i] = marked / 8;
      const Shaded* of_quad[4];
      for (int p = 0; p < 4; ++p)
        of_quad[p] = &samples[static_cast<std::size_t>(((y & ~1) + p / 2) * stride + (x & ~1) + p % 2)];
      if (marked == 0) {
        frame.color[i] = frame.low[i] = frame.high[i] = of_quad[y % 2 * 2 + x % 2]->color;
        continue;
      }
      ++known;
      const auto interpolate = [&](glm::vec4 Shaded::*member, glm::vec4& to) {
        for (int c = 0; c < 4; ++c) {
          const float values[4] = {(of_quad[0]->*member)[c], (of_quad[1]->*member)[c], (of_quad[2]->*member)[c],
                                   (of_quad[3]->*member)[c]};
          to[c] = mean(values, weights, 1.0f / marked);
        }
      };
      interpolate(&Shaded::color, frame.color[i]);
      interpolate(&Shaded::low, frame.low[i]);
      interpolate(&Shaded::high, frame.high[i]);
    }
  }
  const std::size_t pixels = frame.color.size();
  counters.items_in += pixels;
  counters.items_out += pixels;
  counters.ops += pixel_cost() * pixels;
  counters.bytes_read += pixels * (kColorBytes + 4 + 4);  // own colour, visibility id and mask; the quad's by exchange
  counters.bytes_read += pixels * 8 * (kColorBytes + 4);  // the neighbours' colours and ids
  counters.bytes_written += pixels * kColorBytes;
  counters.lanes_used += known;
  counters.lanes_issued += pixels;
}

std::vector<float> unknown_part(const CurrentFrame& frame) {
  std::vector<float> unknown;
  unknown.reserve(frame.known.size());
  for (const float known : frame.known) unknown.push_back(1.0f - known);
  return unknown;
}

}  // namespace beampipe
