#include "stages/samples/dilate.h"

#include <algorithm>

#include "stages/samples/dilate_cost.h"
#include "stages/samples/sample_formulas.h"

namespace beampipe {
namespace {

struct Shaded {
  std::uint32_t draw;
  glm::vec4 color;
};

struct Box {
  glm::vec4 low, high;
};

// The frame's shading samples, at the pixels where they are stored.
class ShadedSamples {
 public:
  ShadedSamples(const QuadFrame& quads, const std::vector<std::uint32_t>& draws, const glm::vec3& background)
      : quads_(quads), draws_(draws), background_(background, 0.0f) {}

  Shaded at(std::int32_t x, std::int32_t y) const {
    const SampleQuad& quad = quads_.quads[static_cast<std::size_t>(y / 2 * quads_.columns + x / 2)];
    const int sample = y % 2 * 2 + x % 2;
    const std::uint32_t triangle = quad.triangle[sample];
    if (triangle == kNoTriangle) return {kNoTriangle, background_};
    return {draws_[triangle], glm::vec4(quad.color[sample], 1.0f)};
  }

  // Only neighbours inside the frame count, because samples outside it are not shaded. Adds their number to
  // `neighbors`.
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
  const std::vector<std::uint32_t>& draws_;
  glm::vec4 background_;
};

glm::vec4 mean_color(const glm::vec4 colors[4], const float weights[4], float inverse) {
  glm::vec4 result;
  for (int c = 0; c < 4; ++c) {
    const float values[4] = {colors[0][c], colors[1][c], colors[2][c], colors[3][c]};
    result[c] = weighted_mean(values, weights, inverse);
  }
  return result;
}

}  // namespace

void dilate(const QuadFrame& quads, const std::vector<std::uint32_t>& draws, const glm::vec3& background,
            const Tile& tile, StageCounters& counters, CurrentFrame& frame) {
  const ShadedSamples samples(quads, draws, background);
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
        frame.color[i] = mean_color(color, weights, 1.0f / marked);
        frame.low[i] = mean_color(low, weights, 1.0f / marked);
        frame.high[i] = mean_color(high, weights, 1.0f / marked);
      }
    }
  }
  charge_dilate(tile.pixels(), known, neighbors, counters);
}

std::vector<float> unknown_part(const CurrentFrame& frame) {
  std::vector<float> unknown;
  unknown.reserve(frame.known.size());
  for (const float known : frame.known) unknown.push_back(1.0f - known);
  return unknown;
}

}  // namespace beampipe
