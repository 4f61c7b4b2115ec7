#include "stages/surface/tested_alpha.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "stages/surface/texture_filter.h"

namespace beampipe {
namespace {

constexpr int kValues = 4;

// The alpha of 3x3 texels, as stored.
using TexelsAround = std::array<std::array<int, 3>, 3>;

TexelsAround neighbors_of(const TextureImage& image, const Texture& texture, std::uint32_t x, std::uint32_t y) {
  TexelsAround found;
  for (int j = 0; j < 3; ++j)
    for (int i = 0; i < 3; ++i) {
      const std::uint32_t column = wrapped(static_cast<std::int32_t>(x) + i - 1, image.width, texture.wrap_u);
      const std::uint32_t row = wrapped(static_cast<std::int32_t>(y) + j - 1, image.height, texture.wrap_v);
      found[static_cast<std::size_t>(j)][static_cast<std::size_t>(i)] =
          image.texels[std::size_t{row} * image.width + column].a;
    }
  return found;
}

glm::vec4 passed(float alpha, const glm::vec4& needed) {
  return {alpha >= needed[0], alpha >= needed[1], alpha >= needed[2], alpha >= needed[3]};
}

// Of the middle texel, which the bilinear filter is tested in at 8 x 8 places.
glm::vec4 shares_of(const TexelsAround& alphas, const glm::vec4& needed) {
  constexpr int kPlaces = 8;
  glm::vec4 sum(0.0f);
  for (int v = 0; v < kPlaces; ++v)
    for (int u = 0; u < kPlaces; ++u) {
      // From the centre of the texel to the left or above it, in sixteenths.
      const int x = 2 * u + 1 + (u < kPlaces / 2 ? 8 : -8), y = 2 * v + 1 + (v < kPlaces / 2 ? 8 : -8);
      const std::size_t left = u < kPlaces / 2 ? 0 : 1, top = v < kPlaces / 2 ? 0 : 1;
      const int upper = alphas[top][left] * (16 - x) + alphas[top][left + 1] * x;
      const int lower = alphas[top + 1][left] * (16 - x) + alphas[top + 1][left + 1] * x;
      sum += passed(static_cast<float>(upper * (16 - y) + lower * y) / (255 * 256), needed);
    }
  return sum / static_cast<float>(kPlaces * kPlaces);
}

// A share of 0 or 1 is that of a texel in which nothing or all passes, in every level: others are not rounded to these.
void keep_parts(MipChain& shares) {
  for (std::size_t l = 1; l < shares.levels.size(); ++l) {
    const MipLevel& larger = shares.levels[l - 1];
    MipLevel& level = shares.levels[l];
    for (std::uint32_t y = 0; y < level.height; ++y)
      for (std::uint32_t x = 0; x < level.width; ++x) {
        glm::u8vec4 least(255), most(0);
        // As make_mip_chain: all that the texel covers.
        const auto first = [](std::uint32_t i, std::uint32_t n, std::uint32_t of) { return i * of / n; };
        const auto last = [](std::uint32_t i, std::uint32_t n, std::uint32_t of) { return ((i + 1) * of - 1) / n; };
        for (std::uint32_t j = first(y, level.height, larger.height); j <= last(y, level.height, larger.height); ++j)
          for (std::uint32_t i = first(x, level.width, larger.width); i <= last(x, level.width, larger.width); ++i) {
            least = glm::min(least, larger.texel(i, j));
            most = glm::max(most, larger.texel(i, j));
          }
        glm::u8vec4& texel = level.texels[std::size_t{y} * level.width + x];
        for (int c = 0; c < 4; ++c) {
          if (least[c] < 255) texel[c] = std::min<std::uint8_t>(texel[c], 254);
          if (most[c] > 0) texel[c] = std::max<std::uint8_t>(texel[c], 1);
        }
      }
  }
}

}  // namespace

float TestedAlpha::share(const glm::vec4& shares_there, float needed) const {
  if (needed <= first) return shares_there[0];
  if (!(needed <= 1.0f)) return 0.0f;
  const float at = std::min((needed - first) / step, kValues - 1.0f);
  const int below = std::min(static_cast<int>(at), kValues - 2);
  const float part = at - static_cast<float>(below);
  return shares_there[below] * (1.0f - part) + shares_there[below + 1] * part;
}

float least_texture_alpha(const Material& material) { return material.alpha_cutoff / material.base_color.a; }

TestedAlpha test_alpha(const Material& material, const TextureImage& image) {
  const Texture& texture = *material.base_texture;
  TestedAlpha tested;
  tested.first = least_texture_alpha(material);
  tested.step = std::max(1.0f - tested.first, 0.0f) / (kValues - 1);
  // The last value is 1 without rounding, so that opaque texels reach it.
  const glm::vec4 needed(tested.first, tested.first + tested.step, tested.first + 2 * tested.step,
                         std::max(tested.first, 1.0f));
  TextureImage shares{image.name, image.width, image.height, std::vector<glm::u8vec4>(image.texels.size())};
  tbb::parallel_for(0u, image.height, [&](std::uint32_t y) {
    for (std::uint32_t x = 0; x < image.width; ++x) {
      const std::size_t at = std::size_t{y} * image.width + x;
      glm::vec4 found = passed(static_cast<float>(image.texels[at].a) / 255, needed);
      if (texture.magnify == Filter::linear) {
        const TexelsAround alphas = neighbors_of(image, texture, x, y);
        bool is_constant = true;
        for (const auto& row : alphas)
          is_constant = is_constant && std::ranges::all_of(row, [&](int alpha) { return alpha == alphas[1][1]; });
        if (!is_constant) found = shares_of(alphas, needed);
      }
      shares.texels[at] = glm::u8vec4(found * 255.0f + 0.5f);
    }
  });
  tested.shares = make_mip_chain(shares, ColorSpace::linear);
  keep_parts(tested.shares);
  return tested;
}

}  // namespace beampipe
