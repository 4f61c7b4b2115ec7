// Texture filtering as glTF's samplers prescribe it: wrap modes, nearest and bilinear filters, and mip levels.
//
// Texture coordinates: (0, 0) is the upper left corner of the image and (1, 1) its lower right corner.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>

#include "stages/surface/mip_chain.h"
#include "traces/material.h"

namespace beampipe {

// How texture coordinates change per pixel, to the right and down.
struct TextureSlopes {
  glm::vec2 dx{0.0f}, dy{0.0f};
};

// The logarithm to base 2 of a positive normal number, within 2e-6. The C library's has other bits on other machines.
inline float logarithm_2(float x) {
  const auto bits = std::bit_cast<std::uint32_t>(x);
  const auto exponent = static_cast<float>(static_cast<std::int32_t>(bits >> 23) - 127);
  const float mantissa = std::bit_cast<float>((bits & 0x7fffffu) | 0x3f800000u);  // 1..2
  const float s = (mantissa - 1.0f) / (mantissa + 1.0f), s2 = s * s;
  const float series = 1.0f + s2 * (1.0f / 3 + s2 * (1.0f / 5 + s2 * (1.0f / 7 + s2 * (1.0f / 9))));
  return exponent + 2.885390082f * s * series;  // 2 / ln 2
}

// The square of the longer side of a pixel's footprint, in texels of the image. It may be any number, and NaN.
inline float squared_footprint(const TextureSlopes& slopes, const MipLevel& image) {
  const glm::vec2 size(image.width, image.height);
  const glm::vec2 dx = slopes.dx * size, dy = slopes.dy * size;
  return std::max(dx.x * dx.x + dx.y * dx.y, dy.x * dy.x + dy.y * dy.y);
}

// The level of detail: the logarithm of that side; always finite. There are no branches, so that the compiler can
// compute several at once. Source: OpenGL 4.6 core specification, section 8.14.
inline float level_of_detail(float squared_footprint) {
  constexpr float kLeast = 1e-30f, kMost = 1e30f;
  const float lod = 0.5f * logarithm_2(squared_footprint < kMost ? squared_footprint : kMost);
  return squared_footprint > kLeast ? lod : -50.0f;
}

inline float level_of_detail(const TextureSlopes& slopes, const MipLevel& image) {
  return level_of_detail(squared_footprint(slopes, image));
}

// The largest whole number that is not above x, which is less than 2^31 away from 0. std::floor is a function call on
// machines that may lack the instruction.
inline std::int32_t floor_of(float x) {
  const auto whole = static_cast<std::int32_t>(x);
  return whole - (static_cast<float>(whole) > x);
}

// The number of a texel as a number within the image. It lies between -1 and 2 * size, as in_texels() sees to, or
// anywhere with Wrap::clamp. There is no division.
inline std::uint32_t wrapped(std::int32_t texel, std::uint32_t size, Wrap wrap) {
  const auto n = static_cast<std::int32_t>(size);
  if (wrap == Wrap::clamp) return static_cast<std::uint32_t>(std::clamp(texel, 0, n - 1));
  const std::int32_t period = wrap == Wrap::repeat ? n : 2 * n;
  texel += texel < 0 ? period : 0;
  for (int i = 0; i < 2; ++i) texel -= texel >= period ? period : 0;
  return static_cast<std::uint32_t>(texel < n ? texel : 2 * n - 1 - texel);
}

// A texture coordinate in texels of a level. Coordinates that are not finite, or so large that texels cannot be told
// apart, become 0.
inline float in_texels(float coordinate, std::uint32_t size, Wrap wrap) {
  constexpr float kMost = 1 << 24;
  if (!(std::abs(coordinate) < kMost)) return 0.0f;
  // the period of `mirror`
  if (wrap != Wrap::clamp) coordinate -= 2.0f * static_cast<float>(floor_of(0.5f * coordinate));
  return std::clamp(coordinate, -1.0f, 3.0f) * static_cast<float>(size);
}

// The two texels, in a row or column of this size, around a place in texels, and the share of the second one.
struct TexelPair {
  std::uint32_t first, second;
  float share;
};
inline TexelPair texels_around(float place, std::uint32_t size, Wrap wrap) {
  const std::int32_t first = floor_of(place - 0.5f);
  return {wrapped(first, size, wrap), wrapped(first + 1, size, wrap), place - 0.5f - static_cast<float>(first)};
}

// Calls read(level, x, y) with each texel that is read. Inlined, because a vector that comes back from a call in parts
// and is then used as a whole makes the processor wait.
template <class Read>
[[gnu::always_inline]] inline glm::vec4 mixed_texels(const MipChain& chain, std::size_t level, const TexelPair& columns,
                                                     const TexelPair& rows, Read&& read) {
  const MipLevel& image = chain.levels[level];
  const TexelValues& values = texel_values(chain.space);
  for (const std::uint32_t row : {rows.first, rows.second})
    for (const std::uint32_t column : {columns.first, columns.second}) read(level, column, row);
  const glm::u8vec4& upper_left = image.texel(columns.first, rows.first);
  const glm::u8vec4& upper_right = image.texel(columns.second, rows.first);
  const glm::u8vec4& lower_left = image.texel(columns.first, rows.second);
  const glm::u8vec4& lower_right = image.texel(columns.second, rows.second);
  const float left_share = 1.0f - columns.share, upper_share = 1.0f - rows.share;
  const auto mixed = [&](const std::array<float, 256>& value, int channel) {
    const float upper = value[upper_left[channel]] * left_share + value[upper_right[channel]] * columns.share;
    const float lower = value[lower_left[channel]] * left_share + value[lower_right[channel]] * columns.share;
    return upper * upper_share + lower * rows.share;
  };
  return {mixed(values.color, 0), mixed(values.color, 1), mixed(values.color, 2), mixed(values.alpha, 3)};
}

template <class Read>
[[gnu::always_inline]] inline glm::vec4 filtered_level(const MipChain& chain, const Texture& texture, std::size_t level,
                                                       const glm::vec2& uv, Filter filter, Read&& read) {
  const MipLevel& image = chain.levels[level];
  const float u = in_texels(uv.x, image.width, texture.wrap_u), v = in_texels(uv.y, image.height, texture.wrap_v);
  if (filter == Filter::nearest) {
    const std::uint32_t column = wrapped(floor_of(u), image.width, texture.wrap_u);
    const std::uint32_t row = wrapped(floor_of(v), image.height, texture.wrap_v);
    read(level, column, row);
    return texel_values(chain.space)(image.texel(column, row));
  }
  return mixed_texels(chain, level, texels_around(u, image.width, texture.wrap_u),
                      texels_around(v, image.height, texture.wrap_v), read);
}

// The mean of the nearest texels over a rectangle that is no larger than a texel: of four texels by their parts.
// `step_width`: its sides, in texture coordinates.
template <class Read>
glm::vec4 mean_of_steps(const MipChain& chain, const Texture& texture, const glm::vec2& uv, const glm::vec2& step_width,
                        Read&& read) {
  const MipLevel& image = chain.levels[0];
  const auto parts = [](TexelPair around, float side) {
    around.share = std::clamp((around.share - 0.5f) / std::max(side, 1e-6f) + 0.5f, 0.0f, 1.0f);
    return around;
  };
  const float u = in_texels(uv.x, image.width, texture.wrap_u), v = in_texels(uv.y, image.height, texture.wrap_v);
  return mixed_texels(
      chain, 0, parts(texels_around(u, image.width, texture.wrap_u), step_width.x * static_cast<float>(image.width)),
      parts(texels_around(v, image.height, texture.wrap_v), step_width.y * static_cast<float>(image.height)), read);
}

// The four texels around a place in a level, as filtered_level() mixes them: upper left, upper right, lower left, lower
// right; and their numbers in the level. Calls read(level, x, y) with each.
struct TexelQuad {
  std::array<glm::vec4, 4> texels;
  TexelPair columns, rows;
};
template <class Read>
TexelQuad texels_around(const MipChain& chain, const Texture& texture, std::size_t level, const glm::vec2& uv,
                        Read&& read) {
  const MipLevel& image = chain.levels[level];
  TexelQuad quad;
  quad.columns = texels_around(in_texels(uv.x, image.width, texture.wrap_u), image.width, texture.wrap_u);
  quad.rows = texels_around(in_texels(uv.y, image.height, texture.wrap_v), image.height, texture.wrap_v);
  std::size_t i = 0;
  for (const std::uint32_t row : {quad.rows.first, quad.rows.second})
    for (const std::uint32_t column : {quad.columns.first, quad.columns.second}) {
      read(level, column, row);
      quad.texels[i++] = chain.texel(level, column, row);
    }
  return quad;
}

// How a texture is filtered somewhere: in which levels, and at how many points.
struct FilterPlan {
  bool is_minified = false;        // a texel is smaller than the area
  Filter filter = Filter::linear;  // in a level
  std::size_t level = 0;           // the finer one
  bool has_next = false;           // the next level is read as well
  float share = 0;                 // of the next level
  float probes = 1, rows = 1;      // whole numbers; in each row so many probes
  glm::vec2 along{0.0f};           // texture coordinates along which the probes of a row lie
  glm::vec2 across{0.0f};          // and along which the rows lie
  glm::vec2 step_width{0.0f};      // not 0: the mean of the nearest texels over so many texture coordinates

  bool is_step() const { return filter == Filter::nearest && step_width != glm::vec2(0.0f); }
  std::uint64_t texels() const {
    return static_cast<std::uint64_t>(probes * rows) * (filter == Filter::nearest && !is_step() ? 1u : 4u) *
           (has_next ? 2u : 1u);
  }
};

// Anisotropic filtering takes several probes, evenly along the longer side of the footprint, in the level that fits the
// shorter side, or the longer side divided by the number of probes.
// Source: Khronos, EXT_texture_filter_anisotropic, "sample implementation".
// `lod`: the level of detail of these slopes in the image.
inline FilterPlan filter_plan(const MipChain& chain, const Texture& texture, const TextureSlopes& slopes, float lod) {
  FilterPlan plan{.filter = texture.magnify};
  if (lod <= 0) return plan;
  plan.is_minified = true, plan.filter = texture.minify;
  if (texture.mip == MipFilter::none) return plan;
  const auto last = static_cast<float>(chain.levels.size() - 1);
  if (texture.mip == MipFilter::nearest) {
    plan.level = static_cast<std::size_t>(std::min(std::ceil(lod + 0.5f) - 1, last));
    return plan;
  }
  if (texture.anisotropy > 1) {
    const glm::vec2 size(chain.levels[0].width, chain.levels[0].height);
    const glm::vec2 dx = slopes.dx * size, dy = slopes.dy * size;
    const float squared_x = dx.x * dx.x + dx.y * dx.y, squared_y = dy.x * dy.x + dy.y * dy.y;
    const float longer = std::sqrt(std::max(squared_x, squared_y)), shorter = std::sqrt(std::min(squared_x, squared_y));
    const auto most = static_cast<float>(texture.anisotropy);
    plan.along = squared_x >= squared_y ? slopes.dx : slopes.dy;
    plan.probes = longer < shorter * most ? std::max(std::ceil(longer / shorter), 1.0f) : most;
    lod = logarithm_2(std::max(longer / plan.probes, 1e-30f));
    if (!(lod > 0)) {
      plan.filter = texture.magnify;
      return plan;
    }
  }
  plan.level = static_cast<std::size_t>(floor_of(std::min(lod, last)));
  plan.has_next = plan.level + 1 < chain.levels.size();
  plan.share = lod - static_cast<float>(plan.level);
  return plan;
}
inline FilterPlan filter_plan(const MipChain& chain, const Texture& texture, const TextureSlopes& slopes) {
  return filter_plan(chain, texture, slopes, level_of_detail(slopes, chain.levels[0]));
}

// Linear RGBA. Calls read(level, x, y) with each texel that is read.
template <class Read>
glm::vec4 filtered(const MipChain& chain, const Texture& texture, const glm::vec2& uv, const FilterPlan& plan,
                   Read&& read) {
  if (plan.is_step()) return mean_of_steps(chain, texture, uv, plan.step_width, read);
  glm::vec4 sum(0.0f);
  for (float j = 0; j < plan.rows; ++j) {
    const glm::vec2 row = plan.rows == 1 ? uv : uv + plan.across * ((j + 0.5f) / plan.rows - 0.5f);
    for (float i = 0; i < plan.probes; ++i) {
      const glm::vec2 at = plan.probes == 1 ? row : row + plan.along * ((i + 0.5f) / plan.probes - 0.5f);
      const glm::vec4 color = filtered_level(chain, texture, plan.level, at, plan.filter, read);
      sum += plan.has_next ? color * (1.0f - plan.share) +
                                 filtered_level(chain, texture, plan.level + 1, at, plan.filter, read) * plan.share
                           : color;
    }
  }
  const float probes = plan.probes * plan.rows;
  return probes == 1 ? sum : sum / probes;
}
template <class Read>
glm::vec4 filtered(const MipChain& chain, const Texture& texture, const glm::vec2& uv, const TextureSlopes& slopes,
                   Read&& read) {
  return filtered(chain, texture, uv, filter_plan(chain, texture, slopes), read);
}

}  // namespace beampipe
