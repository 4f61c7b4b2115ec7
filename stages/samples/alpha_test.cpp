#include "stages/samples/alpha_test.h"

#include <algorithm>

#include "stages/samples/alpha_test_cost.h"
#include "stages/surface/opacity.h"

namespace beampipe {

void alpha_test(const TileShader& shader, const AlphaTest& test, StageCounters& counters,
                std::vector<SampleFragment>& fragments, TexelRequests* texels) {
  const CellGrid& grid = test.sampling.grid;
  const int samples = test.sampling.pattern.count;
  std::uint64_t tested = 0, left = 0;
  OperationCounts alphas;
  for (std::size_t i = 0; i < fragments.size(); ++i) {
    SampleFragment& fragment = fragments[i];
    if (!shader.is_cutout(fragment.triangle)) continue;
    ++tested;
    alphas += shader.work(fragment.triangle).alpha;
    if (i > 0 && fragments[i - 1].quad != fragment.quad) end_request(texels);
    const std::int32_t x = grid.pixel_x(fragment.x), y = grid.pixel_y(fragment.y);
    const auto pixel = static_cast<std::uint32_t>(test.tile.index(x, y));
    const float alpha =
        shader.alpha(fragment.triangle, pixel, test.places[i].x, test.places[i].y, grid.shading_width(), texels);
    if (test.coverage == AlphaCoverage::test) {
      if (alpha < shader.alpha_cutoff(fragment.triangle)) fragment.mask = 0;
    } else {
      const OpacityRanks ranks(0, fragment.x, fragment.y,
                               static_cast<std::uint32_t>(samples));  // the same samples for all surfaces
      for (int s = 0; s < samples; ++s)
        if (!ranks.takes(static_cast<std::uint32_t>(s), alpha)) fragment.mask &= ~(1u << s);
    }
    left += fragment.mask != 0;
  }
  end_request(texels);
  std::erase_if(fragments, [](const SampleFragment& fragment) { return fragment.mask == 0; });
  charge_alpha_test(tested, left, test.coverage == AlphaCoverage::test ? 0 : samples, alphas, counters);
}

}  // namespace beampipe
