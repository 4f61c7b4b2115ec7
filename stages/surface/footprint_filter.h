// The mean of a texture over a pixel's footprint: a grid of bilinear taps along both of its sides, in the finest mip
// level in which so many taps leave no gaps. In place of a sampler's own filters, which take one square (trilinear) or
// a row of squares (anisotropic).
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>

#include "stages/surface/texture_filter.h"

namespace beampipe {

// A footprint's sides in texture coordinates, and their lengths in texels.
struct FootprintSides {
  glm::vec2 along, across;
  float length, width;
};

// Sides that are within 60 degrees of each other become those of the rectangle with the same mean squares, on which a
// grid of taps is even. `size`: of the image, in texels.
inline FootprintSides footprint_sides(const TextureSlopes& slopes, const glm::vec2& size) {
  glm::vec2 along = slopes.dx * size, across = slopes.dy * size;
  const float aa = glm::dot(along, along), bb = glm::dot(across, across), ab = glm::dot(along, across);
  if (4 * ab * ab > aa * bb) {
    // One rotation of Jacobi's method for singular values.
    const float ratio = (bb - aa) / (2 * ab);
    const float tangent = (ratio < 0 ? -1.0f : 1.0f) / (std::abs(ratio) + std::sqrt(1 + ratio * ratio));
    const float cosine = 1 / std::sqrt(1 + tangent * tangent), sine = cosine * tangent;
    const glm::vec2 turned = along * cosine - across * sine;
    across = along * sine + across * cosine;
    along = turned;
  }
  return {along / size, across / size, std::sqrt(glm::dot(along, along)), std::sqrt(glm::dot(across, across))};
}

// The distance of taps in texels of their level, at most. The farther they lie from each other, the finer the level;
// but at two texels they would read each second texel alone. At this distance the weights of texels are within a fifth
// of each other. A single tap reaches as far as its four texels.
inline float tap_distance(int most_taps) { return most_taps == 1 ? 2.0f : 1.25f; }

// How much wider than the side of a footprint its taps lie so that they have the second moment of the side. The
// texels of a level and the bilinear filter between them have blurred the image already. `side`: in texels of the
// level.
inline float tap_spread(float side, float taps, std::size_t level) {
  if (taps == 1) return 0.0f;
  const float blur = 3.0f - std::ldexp(3.0f, -2 * static_cast<int>(level));  // 12 times its variance
  return std::sqrt(std::max(side * side - blur, 0.0f) * (taps * taps / (taps * taps - 1))) / side;
}

// The finest level in which the four texels around the middle of a footprint cover all of it, and the longer side of
// the footprint's bounds in texels of that level: at most 1, or more in the last level.
struct CoveringLevel {
  std::size_t level = 0;
  float side = 0;
};
inline CoveringLevel covering_level(const MipChain& chain, const TextureSlopes& slopes) {
  const glm::vec2 size(chain.levels[0].width, chain.levels[0].height);
  const glm::vec2 bounds = (glm::abs(slopes.dx) + glm::abs(slopes.dy)) * size;
  CoveringLevel found{0, std::max(bounds.x, bounds.y)};
  while (!(found.side <= 1) && found.level + 1 < chain.levels.size()) ++found.level, found.side /= 2;
  return found;
}

// `most_taps`: 1, 4 or 16.
inline FilterPlan footprint_plan(const MipChain& chain, const Texture& texture, const TextureSlopes& slopes,
                                 int most_taps) {
  const FootprintSides sides = footprint_sides(slopes, {chain.levels[0].width, chain.levels[0].height});
  FilterPlan plan{.filter = texture.magnify};
  constexpr float kFarthest = 1 << 24;  // in texels; beyond it, and for what is no number, the last level
  if (!(sides.length < kFarthest && sides.width < kFarthest)) {
    plan.is_minified = true, plan.filter = Filter::linear, plan.level = chain.levels.size() - 1;
    return plan;
  }
  plan.is_minified = std::max(sides.length, sides.width) > 1;
  if (!plan.is_minified) {
    plan.step_width = glm::sqrt(slopes.dx * slopes.dx + slopes.dy * slopes.dy);
    return plan;
  }
  plan.filter = Filter::linear;
  float length = sides.length, width = sides.width;
  const auto taps_of = [distance = tap_distance(most_taps)](float side) {
    return static_cast<float>(1 + floor_of(side / distance));
  };
  while (taps_of(length) * taps_of(width) > static_cast<float>(most_taps) && plan.level + 1 < chain.levels.size())
    ++plan.level, length /= 2, width /= 2;
  if (taps_of(length) * taps_of(width) > static_cast<float>(most_taps)) return plan;
  plan.probes = taps_of(length), plan.rows = taps_of(width);
  plan.along = sides.along * tap_spread(length, plan.probes, plan.level);
  plan.across = sides.across * tap_spread(width, plan.rows, plan.level);
  return plan;
}

}  // namespace beampipe
