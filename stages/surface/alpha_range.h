// What alpha a texture may have in an area, from its texels.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "stages/surface/mip_chain.h"
#include "stages/surface/texture_filter.h"
#include "traces/material.h"

namespace beampipe {

struct AlphaRange {
  float least = 1, most = 1;
};

// Of magnified texels at any texture coordinates from `low` to `high`, and one texel beyond, which makes up for the
// rounding of coordinates. None if there are more than 24 x 24 texels, or if a coordinate is no number.
inline std::optional<AlphaRange> alpha_range(const MipChain& chain, const Texture& texture, const glm::vec2& low,
                                             const glm::vec2& high) {
  constexpr float kMostTexels = 24, kFarthest = 1 << 20;
  const MipLevel& image = chain.levels[0];
  const glm::vec2 size(image.width, image.height);
  const glm::vec2 from = glm::floor(low * size - 1.5f), to = glm::floor(high * size + 1.5f);
  for (int i = 0; i < 2; ++i)
    if (!(std::max(std::abs(from[i]), std::abs(to[i])) < kFarthest && to[i] - from[i] < kMostTexels))
      return std::nullopt;
  // As `wrapped`, of any number.
  const auto in_image = [](std::int32_t texel, std::uint32_t length, Wrap wrap) {
    const auto n = static_cast<std::int32_t>(length), period = wrap == Wrap::mirror ? 2 * n : n;
    return wrapped(wrap == Wrap::clamp ? texel : (texel % period + period) % period, length, wrap);
  };
  const std::array<float, 256>& alpha = texel_values(chain.space).alpha;
  std::uint8_t least = 255, most = 0;
  for (auto y = static_cast<std::int32_t>(from.y); y <= static_cast<std::int32_t>(to.y); ++y) {
    const std::uint32_t row = in_image(y, image.height, texture.wrap_v);
    for (auto x = static_cast<std::int32_t>(from.x); x <= static_cast<std::int32_t>(to.x); ++x) {
      const std::uint8_t code = image.texel(in_image(x, image.width, texture.wrap_u), row).a;
      least = std::min(least, code), most = std::max(most, code);
    }
  }
  return AlphaRange{alpha[least], alpha[most]};
}

}  // namespace beampipe
