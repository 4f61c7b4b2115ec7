#include "stages/samples/alpha_test.h"

#include <algorithm>
#include <bit>

#include "stages/samples/alpha_test_cost.h"
#include "stages/surface/hashed_alpha.h"
#include "stages/surface/opacity.h"

namespace beampipe {
namespace {

class AlphaTester {
 public:
  AlphaTester(const TileShader& shader, const AlphaTest& test, TexelRequests* texels)
      : shader_(shader), test_(test), samples_(test.sampling.pattern.count), texels_(texels) {}

  // By a single invocation. Sets the fragment's depth.
  void judge(SampleFragment& fragment, std::size_t i) const {
    const CellGrid& grid = test_.sampling.grid;
    const std::int32_t x = grid.pixel_x(fragment.x), y = grid.pixel_y(fragment.y);
    const ShadingPlace place =
        shader_.place(static_cast<std::uint32_t>(test_.tile.index(x, y)), test_.places[i].x, test_.places[i].y);
    const FragmentVerdict verdict = shader_.verdict({fragment.triangle, place, grid.shading_width()}, false, texels_);
    const TakenPositions taken(verdict, x, y, static_cast<std::uint32_t>(samples_ * grid.cells_per_pixel()));
    const std::int32_t first = samples_ * grid.in_pixel(fragment.x, fragment.y);
    for (std::int32_t s = 0; s < samples_; ++s)
      if (!taken.takes(static_cast<std::uint32_t>(first + s))) fragment.mask &= ~(1u << s);
    fragment.depth = verdict.depth;
  }

  // The samples of fragment i that pass.
  std::uint32_t passed(const SampleFragment& fragment, std::size_t i) const {
    const CellGrid& grid = test_.sampling.grid;
    const auto pixel = static_cast<std::uint32_t>(test_.tile.index(grid.pixel_x(fragment.x), grid.pixel_y(fragment.y)));
    const float width = grid.shading_width();
    const auto alpha_at = [&](const glm::vec2& place) {
      return shader_.alpha(fragment.triangle, pixel, place.x, place.y, width, texels_);
    };
    const auto those = [&](auto&& passes) {
      std::uint32_t mask = 0;
      for (int s = 0; s < samples_; ++s)
        if ((fragment.mask >> s & 1u) && passes(s)) mask |= 1u << s;
      return mask;
    };
    const float cutoff = shader_.alpha_cutoff(fragment.triangle);
    if (test_.coverage == AlphaCoverage::by_sample)
      return those([&](int s) { return alpha_at(place_of(fragment, s)) >= cutoff; });

    const glm::vec2& place = test_.places[i];
    const float alpha = alpha_at(place);
    if (test_.coverage == AlphaCoverage::test) return alpha >= cutoff ? fragment.mask : 0;
    if (test_.coverage == AlphaCoverage::hashed) {
      const auto [uv, right, down] = shader_.alpha_place(fragment.triangle, pixel, place.x, place.y, width);
      const float threshold = hashed_threshold(uv, right, down);
      return those([&](int s) { return alpha > threshold_of(threshold, s, samples_); });
    }
    const OpacityRanks ranks(0, fragment.x, fragment.y, static_cast<std::uint32_t>(samples_));
    return those([&](int s) { return ranks.takes(static_cast<std::uint32_t>(s), alpha); });
  }

 private:
  // In its pixel, from the upper left corner.
  glm::vec2 place_of(const SampleFragment& fragment, int s) const {
    const CellGrid& grid = test_.sampling.grid;
    const SamplePattern& pattern = test_.sampling.pattern;
    const std::int32_t x = (fragment.x & (grid.columns - 1)) * grid.cell_width() + pattern.x[s],
                       y = (fragment.y & (grid.rows - 1)) * grid.cell_height() + pattern.y[s];
    return glm::vec2(x, y) / float{kSubpixelUnits};
  }

  const TileShader& shader_;
  const AlphaTest& test_;
  int samples_;
  TexelRequests* texels_;
};

}  // namespace

void alpha_test(const TileShader& shader, const AlphaTest& test, StageCounters& counters,
                std::vector<SampleFragment>& fragments, TexelRequests* texels) {
  const AlphaTester tester(shader, test, texels);
  AlphaTestWork work;
  std::uint32_t in_quad = 0;  // samples that fragments of the quad have
  for (std::size_t i = 0; i < fragments.size(); ++i) {
    SampleFragment& fragment = fragments[i];
    if (starts_quad(fragments, i)) end_request(texels), in_quad = 0;
    const bool has_verdict = shader.has_verdict(fragment.triangle);
    if (!shader.is_cutout(fragment.triangle) && !has_verdict) continue;
    if (shader.tests_early(fragment.triangle) != test.is_after_tests) continue;
    // Lanes of a quad run together: once, or for each sample that one of them has.
    const std::uint32_t runs = test.coverage == AlphaCoverage::by_sample && !has_verdict ? fragment.mask : 1u;
    work.add(static_cast<std::uint64_t>(std::popcount(runs)),
             static_cast<std::uint64_t>(std::popcount(runs & ~in_quad)), shader.work(fragment.triangle).alpha);
    in_quad |= runs;
    if (has_verdict) {
      tester.judge(fragment, i);
    } else {
      fragment.mask = tester.passed(fragment, i);
    }
    work.left += fragment.mask != 0;
  }
  end_request(texels);
  std::erase_if(fragments, [](const SampleFragment& fragment) { return fragment.mask == 0; });
  charge(work, test, counters);
}

}  // namespace beampipe
