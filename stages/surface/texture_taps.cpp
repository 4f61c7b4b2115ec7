#include "stages/surface/texture_taps.h"

#include <array>
#include <cstddef>
#include <cstdint>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "stages/surface/texture_taps.cpp"
#include "hwy/foreach_target.h"
// foreach_target comes first
#include "hwy/highway.h"
#include "simd/lanes-inl.h"

#ifndef BEAMPIPE_STAGES_SURFACE_TEXTURE_TAPS_CPP_
#define BEAMPIPE_STAGES_SURFACE_TEXTURE_TAPS_CPP_
namespace beampipe {
namespace {

// Bilinear look-ups that wait until there are enough of them. A member is an array over them.
struct Taps {
  static constexpr std::size_t kMost = 256;  // a whole number of vectors
  std::size_t count = 0;
  // What lies beyond `count` is looked up, too, by the last vector.
  alignas(64) std::array<float, kMost> u{}, v{};
  alignas(64) std::array<std::int32_t, kMost> level{};
  std::array<glm::vec4, kMost> color;  // found
};

// By level.
struct LevelSizes {
  std::array<std::uint32_t, 32> widths{}, heights{};
};

}  // namespace
}  // namespace beampipe
#endif

HWY_BEFORE_NAMESPACE();
namespace beampipe {
namespace HWY_NAMESPACE {

#include "stages/surface/texel_place-inl.h"

// The first two in a row or column, and the share of the second one.
struct SidePlaces {
  alignas(64) std::array<std::int32_t, Taps::kMost> first, second;
  alignas(64) std::array<float, Taps::kMost> share;
};

void find_sides(const std::array<float, Taps::kMost>& coordinates, const std::array<std::int32_t, Taps::kMost>& levels,
                std::size_t count, const std::array<std::uint32_t, 32>& sizes, Wrap wrap, SidePlaces& places) {
  constexpr FloatTag floats;
  constexpr IntTag ints;
  for (std::size_t i = 0; i < count; i += hn::Lanes(floats)) {
    const Ints level(hn::Load(ints, levels.data() + i));
    const Ints size(hn::BitCast(ints, fetch(sizes.data(), level).raw));
    const auto [first, second, share] =
        texels_around(in_texels(Floats(hn::Load(floats, coordinates.data() + i)), to_float(size), wrap), size, wrap);
    hn::Store(first.raw, ints, places.first.data() + i);
    hn::Store(second.raw, ints, places.second.data() + i);
    hn::Store(share.raw, floats, places.share.data() + i);
  }
}

void look_up_kernel(const MipChain& chain, const Texture& texture, const LevelSizes& sizes, Taps& taps) {
  SidePlaces columns, rows;
  find_sides(taps.u, taps.level, taps.count, sizes.widths, texture.wrap_u, columns);
  find_sides(taps.v, taps.level, taps.count, sizes.heights, texture.wrap_v, rows);
  const TexelValues& values = texel_values(chain.space);
  for (std::size_t i = 0; i < taps.count; ++i) {
    const MipLevel& image = chain.levels[static_cast<std::size_t>(taps.level[i])];
    const glm::u8vec4* const upper = &image.texels[static_cast<std::size_t>(rows.first[i]) * image.width];
    const glm::u8vec4* const lower = &image.texels[static_cast<std::size_t>(rows.second[i]) * image.width];
    taps.color[i] = mixed_texels(values, {upper[columns.first[i]], upper[columns.second[i]], lower[columns.first[i]],
                                          lower[columns.second[i]], columns.share[i], rows.share[i]});
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace beampipe
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace beampipe {
HWY_EXPORT(look_up_kernel);

void filter_side_by_side(const MipChain& chain, const Texture& texture, std::span<const glm::vec2> uvs,
                         std::span<const FilterPlan> plans, glm::vec4* values) {
  LevelSizes sizes;
  for (std::size_t i = 0; i < chain.levels.size(); ++i)
    sizes.widths[i] = chain.levels[i].width, sizes.heights[i] = chain.levels[i].height;
  Taps taps;
  std::size_t first = 0;  // of the places whose look-ups wait
  const auto finish = [&](std::size_t end) {
    HWY_DYNAMIC_DISPATCH(look_up_kernel)(chain, texture, sizes, taps);
    const glm::vec4* found = taps.color.data();
    for (; first < end; ++first) {
      if (plans[first].filter == Filter::nearest) continue;
      MeanOfProbes mean(plans[first]);
      const auto probes = static_cast<std::size_t>(plans[first].probes * plans[first].rows);
      for (std::size_t i = 0; i < probes; ++i) mean.add([&](std::size_t) { return *found++; });
      values[first] = mean.color();
    }
    taps.count = 0;
  };
  for (std::size_t i = 0; i < uvs.size(); ++i) {
    const FilterPlan& plan = plans[i];
    if (plan.filter == Filter::nearest) {
      values[i] = filtered(chain, texture, uvs[i], plan, [](std::size_t, std::uint32_t, std::uint32_t) {});
      continue;
    }
    if (taps.count + plan.texels() / 4 > Taps::kMost) finish(i);
    const auto add = [&](const glm::vec2& at, std::size_t level) {
      taps.u[taps.count] = at.x, taps.v[taps.count] = at.y;
      taps.level[taps.count++] = static_cast<std::int32_t>(level);
    };
    for_each_probe(plan, uvs[i], [&](const glm::vec2& at) {
      add(at, plan.level);
      if (plan.has_next) add(at, plan.level + 1);
    });
  }
  finish(uvs.size());
}
}  // namespace beampipe
#endif
