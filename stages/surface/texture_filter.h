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
#include <type_traits>

#include "simd/scalar.h"
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

// The two texels, in a row or column, around a place in texels, and the share of the second one.
template <class Real, class Int>
struct TexelPairOf {
  Int first, second;
  Real share;
};

namespace scalar {
#include "stages/surface/texel_place-inl.h"
}
using namespace scalar;

inline std::uint32_t wrapped(std::int32_t texel, std::uint32_t size, Wrap wrap) {
  return static_cast<std::uint32_t>(wrapped(texel, static_cast<std::int32_t>(size), wrap));
}

using TexelPair = TexelPairOf<float, std::uint32_t>;
// `coordinate`: of a texture; `size`: of a level.
inline TexelPair texels_at(float coordinate, std::uint32_t size, Wrap wrap) {
  const auto [first, second, share] =
      texels_around(in_texels(coordinate, static_cast<float>(size), wrap), static_cast<std::int32_t>(size), wrap);
  return {static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(second), share};
}

// Four texels, and the shares of the right and of the lower ones.
struct FourTexels {
  const glm::u8vec4 &upper_left, &upper_right, &lower_left, &lower_right;
  float right_share, lower_share;
};

// Inlined, because a vector that comes back from a call in parts and is then used as a whole makes the processor wait.
[[gnu::always_inline]] inline glm::vec4 mixed_texels(const TexelValues& values, const FourTexels& four) {
  const float left_share = 1.0f - four.right_share, upper_share = 1.0f - four.lower_share;
  const auto mixed = [&](const std::array<float, 256>& value, int channel) __attribute__((always_inline)) {
    const float upper =
        value[four.upper_left[channel]] * left_share + value[four.upper_right[channel]] * four.right_share;
    const float lower =
        value[four.lower_left[channel]] * left_share + value[four.lower_right[channel]] * four.right_share;
    return upper * upper_share + lower * four.lower_share;
  };
  return {mixed(values.color, 0), mixed(values.color, 1), mixed(values.color, 2), mixed(values.alpha, 3)};
}

// Calls read(level, x, y) with each texel that is read.
template <class Read>
[[gnu::always_inline]] inline glm::vec4 mixed_texels(const MipChain& chain, std::size_t level, const TexelPair& columns,
                                                     const TexelPair& rows, Read&& read) {
  const MipLevel& image = chain.levels[level];
  for (const std::uint32_t row : {rows.first, rows.second})
    for (const std::uint32_t column : {columns.first, columns.second}) read(level, column, row);
  return mixed_texels(
      texel_values(chain.space),
      {image.texel(columns.first, rows.first), image.texel(columns.second, rows.first),
       image.texel(columns.first, rows.second), image.texel(columns.second, rows.second), columns.share, rows.share});
}

template <class Read>
[[gnu::always_inline]] inline glm::vec4 filtered_level(const MipChain& chain, const Texture& texture, std::size_t level,
                                                       const glm::vec2& uv, Filter filter, Read&& read) {
  const MipLevel& image = chain.levels[level];
  if (filter == Filter::nearest) {
    const auto nearest = [](float coordinate, std::uint32_t size, Wrap wrap) {
      return wrapped(floor_of(in_texels(coordinate, static_cast<float>(size), wrap)), size, wrap);
    };
    const std::uint32_t column = nearest(uv.x, image.width, texture.wrap_u);
    const std::uint32_t row = nearest(uv.y, image.height, texture.wrap_v);
    read(level, column, row);
    return texel_values(chain.space)(image.texel(column, row));
  }
  return mixed_texels(chain, level, texels_at(uv.x, image.width, texture.wrap_u),
                      texels_at(uv.y, image.height, texture.wrap_v), read);
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
  return mixed_texels(
      chain, 0, parts(texels_at(uv.x, image.width, texture.wrap_u), step_width.x * static_cast<float>(image.width)),
      parts(texels_at(uv.y, image.height, texture.wrap_v), step_width.y * static_cast<float>(image.height)), read);
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
  const TexelValues& values = texel_values(chain.space);
  TexelQuad quad;
  quad.columns = texels_at(uv.x, image.width, texture.wrap_u);
  quad.rows = texels_at(uv.y, image.height, texture.wrap_v);
  std::size_t i = 0;
  for (const std::uint32_t row : {quad.rows.first, quad.rows.second})
    for (const std::uint32_t column : {quad.columns.first, quad.columns.second}) {
      read(level, column, row);
      quad.texels[i++] = values(image.texel(column, row));
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

// Calls visit(at) with the texture coordinates of each probe.
template <class Visit>
void for_each_probe(const FilterPlan& plan, const glm::vec2& uv, Visit&& visit) {
  for (float j = 0; j < plan.rows; ++j) {
    const glm::vec2 row = plan.rows == 1 ? uv : uv + plan.across * ((j + 0.5f) / plan.rows - 0.5f);
    for (float i = 0; i < plan.probes; ++i)
      visit(plan.probes == 1 ? row : row + plan.along * ((i + 0.5f) / plan.probes - 0.5f));
  }
}

class MeanOfProbes {
 public:
  explicit MeanOfProbes(const FilterPlan& plan) : plan_(plan) {}

  // color_in(level): of the probe.
  template <class ColorIn>
  void add(ColorIn&& color_in) {
    const glm::vec4 color = color_in(plan_.level);
    sum_ += plan_.has_next ? color * (1.0f - plan_.share) + color_in(plan_.level + 1) * plan_.share : color;
  }

  glm::vec4 color() const {
    const float probes = plan_.probes * plan_.rows;
    return probes == 1 ? sum_ : sum_ / probes;
  }

 private:
  const FilterPlan& plan_;
  glm::vec4 sum_{0.0f};
};

// Linear RGBA. Calls read(level, x, y) with each texel that is read.
template <class Read>
glm::vec4 filtered(const MipChain& chain, const Texture& texture, const glm::vec2& uv, const FilterPlan& plan,
                   Read&& read) {
  if (plan.is_step()) return mean_of_steps(chain, texture, uv, plan.step_width, read);
  MeanOfProbes mean(plan);
  for_each_probe(plan, uv, [&](const glm::vec2& at) {
    mean.add([&](std::size_t level) { return filtered_level(chain, texture, level, at, plan.filter, read); });
  });
  return mean.color();
}
template <class Read>
glm::vec4 filtered(const MipChain& chain, const Texture& texture, const glm::vec2& uv, const TextureSlopes& slopes,
                   Read&& read) {
  return filtered(chain, texture, uv, filter_plan(chain, texture, slopes), read);
}

}  // namespace beampipe
