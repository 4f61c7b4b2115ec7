#include "stages/beam/alpha_mask.h"

#include <bit>
#include <cmath>

#include "stages/beam/alpha_mask_cost.h"
#include "stages/surface/opacity.h"

namespace beampipe {
namespace {

// Calls body(position, u, v) for each position of the mask; (u, v) lie in the pixel, 0..1. Calls end_word() after each
// word.
template <class Body, class EndWord>
void for_each_position(const WideMask& mask, const std::vector<SamplePattern>& patterns, Body&& body,
                       EndWord&& end_word) {
  for (std::size_t word = 0; word < patterns.size(); ++word) {
    for (std::uint32_t bits = mask.words[word]; bits != 0; bits &= bits - 1) {
      const auto s = static_cast<std::size_t>(std::countr_zero(bits));
      body(32 * word + s, static_cast<float>(patterns[word].x[s]) / kSubpixelUnits,
           static_cast<float>(patterns[word].y[s]) / kSubpixelUnits);
    }
    end_word();
  }
}

// The part of the area of width `width` that a cutout covers.
float covered_part(const TileShader& shader, const Fragment& fragment, float u, float v, float width,
                   AlphaMaskWork& work, TexelRequests* texels) {
  work.alphas += shader.work(fragment.triangle).alpha;
  ++work.tests;
  const SurfaceShader::CutoutPart found = shader.cutout_part(fragment.triangle, fragment.pixel, u, v, width, texels);
  work.mixed += found.is_share;
  return found.part;
}

// The part of the fragment that is left, 0..1.
float cut_out(const TileShader& shader, const std::vector<SamplePattern>& patterns, float spacing, Fragment& fragment,
              AlphaMaskWork& work, TexelRequests* texels) {
  if (fragment.mask.none()) {
    const float part = covered_part(shader, fragment, fragment.centroid_u, fragment.centroid_v, 1.0f, work, texels);
    end_request(texels);
    return part;
  }
  ++work.masks, ++work.shares;
  const OpacityRanks ranks = shader.opacity_ranks(fragment.triangle, fragment.pixel, kMaxMaskSamples * patterns.size());
  const auto covered = static_cast<float>(fragment.mask.count());
  WideMask left;
  float sum = 0;
  const auto test = [&](std::size_t position, float u, float v) {
    ++work.positions;
    const float part = covered_part(shader, fragment, u, v, spacing, work, texels);
    sum += part;
    if (ranks.takes(static_cast<std::uint32_t>(position), part)) left.set(position);
  };
  for_each_position(fragment.mask, patterns, test, [&] { end_request(texels); });
  fragment.mask = left;
  return sum / covered;
}

float let_through(const TileShader& shader, const std::vector<SamplePattern>& patterns, Fragment& fragment,
                  AlphaMaskWork& work, TexelRequests* texels) {
  work.alphas += shader.work(fragment.triangle).alpha;
  const float opacity =
      shader.alpha(fragment.triangle, fragment.pixel, fragment.centroid_u, fragment.centroid_v, 1.0f, texels);
  end_request(texels);
  if (fragment.mask.none()) return opacity;
  ++work.masks;
  const OpacityRanks ranks = shader.opacity_ranks(fragment.triangle, fragment.pixel, kMaxMaskSamples * patterns.size());
  WideMask left;
  const auto rank = [&](std::size_t position, float, float) {
    ++work.ranked;
    if (ranks.takes(static_cast<std::uint32_t>(position), opacity)) left.set(position);
  };
  for_each_position(fragment.mask, patterns, rank, [] {});
  fragment.mask = left;
  return opacity;
}

}  // namespace

void alpha_mask(const TileShader& shader, const std::vector<SamplePattern>& patterns, StageCounters& counters,
                std::vector<Fragment>& fragments, TexelRequests* texels) {
  AlphaMaskWork work;
  const float spacing = 1.0f / std::sqrt(static_cast<float>(kMaxMaskSamples * patterns.size()));
  for (Fragment& fragment : fragments) {
    if (shader.is_opaque(fragment.triangle)) continue;
    ++work.fragments;
    const float part = shader.is_cutout(fragment.triangle) ? cut_out(shader, patterns, spacing, fragment, work, texels)
                                                           : let_through(shader, patterns, fragment, work, texels);
    fragment.alpha *= part;
    fragment.tiny |= fragment.mask.none();
  }
  const std::size_t before = fragments.size();
  std::erase_if(fragments, [](const Fragment& fragment) { return fragment.alpha <= 0; });
  work.dropped = before - fragments.size();
  charge(work, patterns.size(), counters);
}

}  // namespace beampipe
