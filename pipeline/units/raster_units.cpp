#include "pipeline/units/raster_units.h"

#include <algorithm>
#include <iterator>

#include "pipeline/units/sample_places.h"
#include "stages/cost/closed_depth_cost.h"
#include "stages/raster/bin_sort.h"
#include "stages/raster/bin_sort_cost.h"

namespace beampipe {

ConservativeRasterUnit::ConservativeRasterUnit(Bin& bin, std::string buffer, PairDepths depths, Hidden hidden,
                                               std::size_t capacity)
    : bin_(bin),
      stage_(bin.stage(StageId::conservative_raster)),
      buffer_(std::move(buffer)),
      depths_(depths),
      capacity_(capacity) {
  if (hidden == Hidden::kept) return;
  closed_.emplace(bin.tile);
  bin_.holds("closed_depth", closed_->bytes());
}

std::vector<Pair>& ConservativeRasterUnit::operator()(const TriangleList& triangles, const Tile& box) {
  pairs_.clear();
  const std::size_t most = conservative_raster(bin_.triangles(), triangles, box, stage_.timed(), pairs_,
                                               {closed_ ? &*closed_ : nullptr, depths_});
  bin_.holds(buffer_, std::min(most, capacity_) * (depths_ == PairDepths::bounds ? kPairWithDepthBytes : kPairBytes));
  return pairs_;
}

void ConservativeRasterUnit::drop_hidden(std::vector<Pair>& pairs) {
  stage_.counters.items_out -=
      std::erase_if(pairs, [this](const Pair& pair) { return closed_->hides(pair.x, pair.y, pair.nearest); });
  charge(*closed_, stage_.counters);
}

const TriangleList& SampleRasterUnit::drawn_triangles() {
  if (!bin_.context.has_blending() || (translucent_ == Translucent::drawn && !sorts_translucent_)) return bin_.list;
  const SurfaceShader& shader = bin_.context.shader;
  if (sorts_translucent_) {
    drawn_ = bin_.list;
    const auto first = std::stable_partition(drawn_.begin(), drawn_.end(),
                                             [&](std::uint32_t triangle) { return !shader.is_translucent(triangle); });
    const TriangleList blended(first, drawn_.end());
    const BinStage sorting = bin_.stage(StageId::bin_sort);
    std::ranges::copy(sort_far_to_near(bin_.triangles(), blended, sorting.timed()), first);
    sorting.moves_in_l2("bin_lists", 2 * kSortPasses * blended.size() * (sizeof(std::uint32_t) + kKeyBytes));
    return drawn_;
  }
  drawn_.clear();
  std::ranges::copy_if(bin_.list, std::back_inserter(drawn_), [&](std::uint32_t triangle) {
    return shader.is_translucent(triangle) == (translucent_ == Translucent::alone);
  });
  return drawn_;
}

void SampleRasterUnit::test_alpha(const Sampling& sampling, ShadeAt at, bool is_after_tests) {
  const BinStage testing = bin_.stage(StageId::alpha_test, pass_);
  test_alpha(sampling, at, is_after_tests, testing.timed(), bin_.texels(), fragments_);
  bin_.charge_texels(testing);
}

void SampleRasterUnit::test_alpha(const Sampling& sampling, ShadeAt at, bool is_after_tests, StageCounters& counters,
                                  TexelRequests* texels, std::vector<SampleFragment>& fragments) const {
  const SamplePlaces places(bin_, sampling, at);
  alpha_test(bin_.shader(), {bin_.tile, sampling, coverage_, places.of(fragments), is_after_tests}, counters, fragments,
             texels);
}

void SampleRasterUnit::test_alpha_after_tests(const Sampling& sampling, ShadeAt at) {
  const SurfaceShader& shader = bin_.context.shader;
  if (tests_alpha() && std::ranges::any_of(fragments_, [&](const SampleFragment& fragment) {
        return shader.tests_early(fragment.triangle);
      }))
    test_alpha(sampling, at, true);
}

void SampleRasterUnit::tell_all(const TriangleList& drawn, const Sampling& sampling, ShadeAt at) const {
  std::vector<SampleFragment> fragments;
  StageCounters unused;
  sample_raster({bin_.triangles(), bin_.tile, sampling}, drawn, unused, fragments);
  const std::vector<SampleFragment> before_alpha = fragments;
  for (const bool is_after_tests : {false, true})
    if (tests_alpha()) test_alpha(sampling, at, is_after_tests, unused, nullptr, fragments);
  bin_.observer()->has_fragments(sampling, before_alpha, fragments);
}

}  // namespace beampipe
