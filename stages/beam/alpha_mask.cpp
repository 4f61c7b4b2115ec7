#include "stages/beam/alpha_mask.h"

#include <array>
#include <bit>
#include <cmath>
#include <optional>
#include <span>

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

// Places of a pixel on each axis, where its parts are looked up.
int places_of(AlphaPlaces places) { return places == AlphaPlaces::one ? 1 : places == AlphaPlaces::quarters ? 2 : 4; }

// Takes from fragments what their triangles' alpha lets through.
class AlphaMask {
 public:
  AlphaMask(const TileShader& shader, const std::vector<SamplePattern>& patterns, AlphaPlaces places,
            TexelRequests* texels)
      : shader_(shader),
        patterns_(patterns),
        places_(places),
        texels_(texels),
        spacing_(1.0f / std::sqrt(static_cast<float>(kMaxMaskSamples * patterns.size()))) {}

  void operator()(Fragment& fragment) {
    if (!shader_.is_masked(fragment.triangle)) return;
    ++work.fragments;
    const bool has_verdict = shader_.has_verdict(fragment.triangle);
    float part = 1.0f;
    if (shader_.is_cutout(fragment.triangle)) {
      part = cut_out(fragment);
    } else if (!has_verdict) {
      part = let_through(fragment);
    }
    if (has_verdict && part > 0) part *= judge(fragment);
    fragment.alpha *= part;
    fragment.tiny |= fragment.mask.none();
    fragment.whole &= part >= 1.0f;
  }

  AlphaMaskWork work;

 private:
  // The part of the fragment that is left, 0..1.
  float cut_out(Fragment& fragment) {
    if (shader_.alpha_cutoff(fragment.triangle) <= 0.0f) return 1.0f;  // whatever the texture has
    if (fragment.mask.none()) {
      const float part = covered_part(fragment, fragment.centroid_u, fragment.centroid_v, 1.0f);
      end_request(texels_);
      return part;
    }
    const CutoutCover cover = cover_of(fragment);
    if (cover == CutoutCover::all) return 1.0f;
    if (cover == CutoutCover::none) return 0.0f;
    ++work.masks, ++work.shares;
    return places_ == AlphaPlaces::all ? test_each(fragment) : test_parts(fragment);
  }

  // What is known of the whole pixel from one look-up.
  CutoutCover cover_of(const Fragment& fragment) {
    work.alphas += shader_.work(fragment.triangle).alpha;
    ++work.covers;
    const CutoutCover cover = shader_.tested_cover(fragment.triangle, fragment.pixel, texels_);
    end_request(texels_);
    return cover;
  }

  float test_each(Fragment& fragment) {
    const OpacityRanks ranks = ranks_of(fragment);
    const auto covered = static_cast<float>(fragment.mask.count());
    WideMask left;
    float sum = 0;
    const auto test = [&](std::size_t position, float u, float v) {
      ++work.ranked;
      const float part = covered_part(fragment, u, v, spacing_);
      sum += part;
      if (ranks.takes(static_cast<std::uint32_t>(position), part)) left.set(position);
    };
    for_each_position(fragment.mask, patterns_, test, [&] { end_request(texels_); });
    fragment.mask = left;
    return sum / covered;
  }

  // A part of the pixel: its middle and its patch.
  struct Part {
    float u, v;
    std::optional<SurfaceShader::CutoutPatch> patch;
  };

  // Finds the part of a grid of so many parts on each axis that (u, v) lies in, and looks it up if nobody has.
  const Part& look_up(const Fragment& fragment, float u, float v, float places, std::span<Part> parts) {
    const float column = std::floor(u * places), row = std::floor(v * places);
    Part& part = parts[static_cast<std::size_t>(row * places + column)];
    if (part.patch) return part;
    part.u = (column + 0.5f) / places, part.v = (row + 0.5f) / places;
    work.alphas += shader_.work(fragment.triangle).alpha;
    ++work.tests;
    part.patch = shader_.cutout_patch(fragment.triangle, fragment.pixel, part.u, part.v, 1 / places, texels_);
    work.mixed += part.patch->is_share;
    return part;
  }

  // In each part of the pixel, one look-up tells of all positions: alpha between four texels, or the part that passes.
  // Parts that pass in part are looked up in quarters.
  float test_parts(Fragment& fragment) {
    const OpacityRanks ranks = ranks_of(fragment);
    const auto covered = static_cast<float>(fragment.mask.count());
    const auto places = static_cast<float>(places_of(places_));
    std::array<Part, 16> parts;
    std::array<Part, 64> quarters;
    WideMask left;
    float sum = 0;
    const auto test = [&](std::size_t position, float u, float v) {
      const Part* part = &look_up(fragment, u, v, places, parts);
      if (part->patch->is_share && part->patch->part > 0 && part->patch->part < 1)
        part = &look_up(fragment, u, v, 2 * places, quarters);
      float passes;
      if (part->patch->is_share) {
        ++work.ranked;
        passes = part->patch->part;
        if (ranks.takes(static_cast<std::uint32_t>(position), passes)) left.set(position);
      } else {
        ++work.interpolated;
        passes = part->patch->alpha(u - part->u, v - part->v) >= shader_.alpha_cutoff(fragment.triangle) ? 1.0f : 0.0f;
        if (passes > 0) left.set(position);
      }
      sum += passes;
    };
    for_each_position(fragment.mask, patterns_, test, [] {});
    end_request(texels_);
    fragment.mask = left;
    return sum / covered;
  }

  float let_through(Fragment& fragment) {
    work.alphas += shader_.work(fragment.triangle).alpha;
    const float opacity =
        shader_.alpha(fragment.triangle, fragment.pixel, fragment.centroid_u, fragment.centroid_v, 1.0f, texels_);
    end_request(texels_);
    if (fragment.mask.none()) return opacity;
    ++work.masks;
    const OpacityRanks ranks = ranks_of(fragment);
    WideMask left;
    const auto rank = [&](std::size_t position, float, float) {
      ++work.ranked;
      if (ranks.takes(static_cast<std::uint32_t>(position), opacity)) left.set(position);
    };
    for_each_position(fragment.mask, patterns_, rank, [] {});
    fragment.mask = left;
    return opacity;
  }

  // By a single invocation, of what has not been discarded. Sets the fragment's depth.
  float judge(Fragment& fragment) {
    work.alphas += shader_.work(fragment.triangle).alpha;
    const ShadingPlace centroid = shader_.place(fragment.pixel, fragment.centroid_u, fragment.centroid_v);
    const FragmentVerdict verdict = shader_.verdict({fragment.triangle, centroid, 1.0f}, true, texels_);
    end_request(texels_);
    if (verdict.depth) {
      fragment.plane = {*verdict.depth, 0.0f, 0.0f};
      fragment.z_min = fragment.z_max = fragment.centroid_z = *verdict.depth;
    }
    if (fragment.mask.none()) return verdict.coverage * static_cast<float>(std::popcount(verdict.samples)) / 32;
    const auto covered = static_cast<float>(fragment.mask.count());
    WideMask of_samples, left;
    for (std::size_t word = 0; word < patterns_.size(); ++word)
      of_samples.words[word] = fragment.mask.words[word] & verdict.samples;
    const ShadingPlace pixel = shader_.place(fragment.pixel, 0, 0);
    const TakenPositions taken(verdict, pixel.x, pixel.y, static_cast<std::uint32_t>(32 * patterns_.size()));
    const auto take = [&](std::size_t position, float, float) {
      ++work.ranked;
      if (taken.takes(static_cast<std::uint32_t>(position))) left.set(position);
    };
    for_each_position(of_samples, patterns_, take, [] {});
    ++work.masks, ++work.shares;
    fragment.mask = left;
    return verdict.coverage * static_cast<float>(of_samples.count()) / covered;
  }

  // The part of the area of width `width` that a cutout covers.
  float covered_part(const Fragment& fragment, float u, float v, float width) {
    work.alphas += shader_.work(fragment.triangle).alpha;
    ++work.tests;
    const SurfaceShader::CutoutPart found =
        shader_.cutout_part(fragment.triangle, fragment.pixel, u, v, width, texels_);
    work.mixed += found.is_share;
    return found.part;
  }

  OpacityRanks ranks_of(const Fragment& fragment) const {
    return shader_.opacity_ranks(fragment.triangle, fragment.pixel, kMaxMaskSamples * patterns_.size());
  }

  const TileShader& shader_;
  const std::vector<SamplePattern>& patterns_;
  AlphaPlaces places_;
  TexelRequests* texels_;
  float spacing_;  // of the positions, in pixels
};

}  // namespace

void alpha_mask(const TileShader& shader, const std::vector<SamplePattern>& patterns, AlphaPlaces places,
                StageCounters& counters, std::vector<Fragment>& fragments, TexelRequests* texels) {
  AlphaMask mask(shader, patterns, places, texels);
  for (std::size_t i = 0; i < fragments.size(); ++i) {
    const bool is_early = shader.tests_early(fragments[i].triangle);
    Fragment discarded;
    if (is_early) discarded = fragments[i];
    mask(fragments[i]);
    if (!is_early) continue;
    discarded.mask = without(discarded.mask, fragments[i].mask);
    discarded.alpha -= fragments[i].alpha;
    discarded.is_discarded = true, discarded.whole = false;
    if (!discarded.mask.none()) fragments.insert(fragments.begin() + static_cast<std::ptrdiff_t>(++i), discarded);
  }
  const std::size_t before = fragments.size();
  std::erase_if(fragments, [](const Fragment& fragment) { return fragment.alpha <= 0; });
  mask.work.dropped = before - fragments.size();
  charge(mask.work, patterns.size(), counters);
}

}  // namespace beampipe
