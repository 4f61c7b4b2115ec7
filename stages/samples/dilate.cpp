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

  Shaded extra(const ExtraSample& sample) const {
    if (sample.triangle == kNoTriangle) return {kNoTriangle, background_};
    return {draws_[sample.triangle], glm::vec4(sample.color, 1.0f)};
  }

  // Of a sample at pixel (x, y), which is the one stored there unless it is an extra one. Only neighbours inside the
  // frame count, because samples outside it are not shaded. Adds their number to `neighbors`.
  Box box_around(const Shaded& sample, bool is_extra, std::int32_t x, std::int32_t y, const CurrentFrame& frame,
                 std::uint64_t& neighbors) const {
    Box box{sample.color, sample.color};
    for (std::int32_t ny = std::max(y - 1, 0); ny <= std::min(y + 1, frame.height - 1); ++ny) {
      for (std::int32_t nx = std::max(x - 1, 0); nx <= std::min(x + 1, frame.width - 1); ++nx) {
        if (!is_extra && nx == x && ny == y) continue;
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

constexpr std::size_t kMostSamples = kQuadSamples;  // shading samples of a quad, one for each material

glm::vec4 mean_color(const glm::vec4 colors[], const float weights[], int samples, float inverse) {
  glm::vec4 result;
  for (int c = 0; c < 4; ++c) {
    float values[kMostSamples] = {};
    for (int i = 0; i < samples; ++i) values[i] = colors[i][c];
    result[c] = weighted_mean(values, weights, samples, inverse);
  }
  return result;
}

}  // namespace

void dilate(const ShadedQuads& in, const Tile& tile, StageCounters& counters, CurrentFrame& frame) {
  const QuadFrame& quads = in.quads;
  const ShadedSamples samples(quads, in.draws, in.background);
  DilateWork work;
  for (std::int32_t top = tile.y0; top < tile.y1; top += 2) {
    for (std::int32_t left = tile.x0; left < tile.x1; left += 2) {
      const SampleQuad& quad = quads.quads[static_cast<std::size_t>(top / 2 * quads.columns + left / 2)];
      glm::vec4 color[kMostSamples], low[kMostSamples], high[kMostSamples];
      std::uint32_t masks[kMostSamples];
      int count = 0;
      const auto add = [&](const Shaded& sample, std::uint32_t mask, bool is_extra, int p) {
        const Box box = samples.box_around(sample, is_extra, left + p % 2, top + p / 2, frame, work.neighbors);
        color[count] = sample.color, low[count] = box.low, high[count] = box.high, masks[count] = mask;
        ++count;
      };
      for (int p = 0; p < 4; ++p) add(samples.at(left + p % 2, top + p / 2), quad.mask[p], false, p);
      for (const ExtraSample& extra : quad.extras) add(samples.extra(extra), extra.mask, true, extra.location / 8);
      work.extras += quad.extras.size();
      work.ends += quad.extras.size() < in.room;
      for (int p = 0; p < 4; ++p) {
        const std::int32_t x = left + p % 2, y = top + p / 2;
        if (x >= tile.x1 || y >= tile.y1) continue;
        const auto i = static_cast<std::size_t>(y * frame.width + x);
        float weights[kMostSamples];
        const float marked = weigh(masks, count, 0xffu << 8 * p, weights);
        work.pixels_with[count] += 1;
        frame.known[i] = marked / 8;
        if (marked == 0) {
          frame.color[i] = frame.low[i] = frame.high[i] = color[p];
          continue;
        }
        ++work.known;
        frame.color[i] = mean_color(color, weights, count, 1.0f / marked);
        frame.low[i] = mean_color(low, weights, count, 1.0f / marked);
        frame.high[i] = mean_color(high, weights, count, 1.0f / marked);
      }
    }
  }
  charge_dilate(work, counters);
}

std::vector<float> unknown_part(const CurrentFrame& frame) {
  std::vector<float> unknown;
  unknown.reserve(frame.known.size());
  for (const float known : frame.known) unknown.push_back(1.0f - known);
  return unknown;
}

}  // namespace beampipe
