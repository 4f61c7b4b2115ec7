#include "stages/samples/dilate.h"

#include <algorithm>
#include <bit>

#include "simd/scalar.h"
#include "stages/cost/counting.h"

namespace beampipe {
namespace {

constexpr std::uint64_t kSampleBytes = 6 + 4;  // a shading sample's fp16 RGB and its visibility id

struct Shaded {
  std::uint32_t draw;
  glm::vec4 color;
};

struct Box {
  glm::vec4 low, high;
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
    for (int channel = 0; channel < 3 * 4; ++channel) converted(mean(values, weights, inverse));  // colour, low, high
    for (int channel = 0; channel < 3; ++channel) converted(one);  // its own sample, from fp16
  });
}

// A neighbour's colour into the box where it is of the same draw.
template <class Real>
void grow_box(const Real color[4], bool same_draw, Real low[4], Real high[4]) {
  for (int c = 0; c < 4; ++c) {
    low[c] = lesser(low[c], select(same_draw, color[c], low[c]));
    high[c] = greater(high[c], select(same_draw, color[c], high[c]));
  }
}

OperationCounts neighbor_cost() {
  return count_operations([](OperationCounts& counts) {
    const Counted<float> one(1.0f, counts), id(0.0f, counts);
    Counted<float> color[4] = {converted(one), converted(one), converted(one), one}, low[4] = {one, one, one, one},
                   high[4] = {one, one, one, one};
    grow_box(color, id == id, low, high);
  });
}

// The frame's shading samples, at the pixels where they are stored.
class ShadedSamples {
 public:
  ShadedSamples(const QuadFrame& quads, const std::vector<glm::vec3>& colors, const std::vector<std::uint32_t>& draws,
                const glm::vec3& background)
      : quads_(quads), colors_(colors), draws_(draws), background_(background, 0.0f) {}

  Shaded at(std::int32_t x, std::int32_t y) const {
    const SampleQuad& quad = quads_.quads[static_cast<std::size_t>(y / 2 * quads_.columns + x / 2)];
    const std::uint32_t triangle = quad.triangle[y % 2 * 2 + x % 2];
    if (triangle == kNoTriangle) return {kNoTriangle, background_};
    return {draws_[triangle], glm::vec4(colors_[triangle], 1.0f)};
  }

  // Neighbours inside the frame only: samples outside it were never shaded.
  Box box_around(std::int32_t x, std::int32_t y, const CurrentFrame& frame, std::uint64_t& neighbors) const {
    const Shaded sample = at(x, y);
    Box box{sample.color, sample.color};
    for (std::int32_t ny = std::max(y - 1, 0); ny <= std::min(y + 1, frame.height - 1); ++ny) {
      for (std::int32_t nx = std::max(x - 1, 0); nx <= std::min(x + 1, frame.width - 1); ++nx) {
        if (nx == x && ny == y) continue;
        const Shaded other = at(nx, ny);
        grow_box(&other.color.x, other.draw == sample.draw, &box.low.x, &box.high.x);
        ++neighbors;
      }
    }
    return box;
  }

 private:
  const QuadFrame& quads_;
  const std::vector<glm::vec3>& colors_;
  const std::vector<std::uint32_t>& draws_;
  glm::vec4 background_;
};

glm::vec4 weighted_mean(const glm::vec4 colors[4], const float weights[4], float inverse) {
  glm::vec4 result;
  for (int c = 0; c < 4; ++c) {
    const float values[4] = {colors[0][c], colors[1][c], colors[2][c], colors[3][c]};
    result[c] = mean(values, weights, inverse);
  }
  return result;
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
            const glm::vec3& background, const Tile& tile, StageCounters& counters, CurrentFrame& frame) {
  const ShadedSamples samples(quads, colors, draws, background);
  std::uint64_t known = 0, neighbors = 0;
  for (std::int32_t top = tile.y0; top < tile.y1; top += 2) {
    for (std::int32_t left = tile.x0; left < tile.x1; left += 2) {
      const SampleQuad& quad = quads.quads[static_cast<std::size_t>(top / 2 * quads.columns + left / 2)];
      glm::vec4 color[4], low[4], high[4];
      for (int p = 0; p < 4; ++p) {
        color[p] = samples.at(left + p % 2, top + p / 2).color;
        const Box box = samples.box_around(left + p % 2, top + p / 2, frame, neighbors);
        low[p] = box.low, high[p] = box.high;
      }
      for (int p = 0; p < 4; ++p) {
        const std::int32_t x = left + p % 2, y = top + p / 2;
        if (x >= tile.x1 || y >= tile.y1) continue;
        const auto i = static_cast<std::size_t>(y * frame.width + x);
        float weights[4];
        const float marked = weigh(quad.mask, 0xffu << 8 * p, weights);
        frame.known[i] = marked / 8;
        if (marked == 0) {
          frame.color[i] = frame.low[i] = frame.high[i] = color[p];
          continue;
        }
        ++known;
        frame.color[i] = weighted_mean(color, weights, 1.0f / marked);
        frame.low[i] = weighted_mean(low, weights, 1.0f / marked);
        frame.high[i] = weighted_mean(high, weights, 1.0f / marked);
      }
    }
  }
  const std::size_t pixels = tile.pixels();
  counters.items_in += pixels;
  counters.items_out += pixels;
  counters.ops += pixel_cost() * pixels;
  counters.ops += neighbor_cost() * neighbors;
  counters.bytes_read += pixels * (kSampleBytes + 4);  // its own sample and mask; the quad's by exchange
  counters.bytes_read += neighbors * kSampleBytes;
  counters.bytes_written += pixels * (kCurrentColorBytes + kCurrentBoxBytes);
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
