#include "stages/samples/ordered_blend.h"

#include <bit>

#include "stages/data/sample_tile.h"
#include "stages/rop/rop_cost.h"
#include "stages/rop/stored_color.h"

namespace beampipe {

void ordered_blend(const SampledTriangles& in, const RopRules& rules, const ColoredFragments& fragments,
                   StageCounters& counters, OrderedTile& surface, std::vector<OrderedAccess>& accesses) {
  const auto& [triangles, tile, sampling] = in;
  const CellGrid& grid = sampling.grid;
  const auto samples = static_cast<std::size_t>(sampling.pattern.count),
             cells = static_cast<std::size_t>(grid.cells_per_pixel());
  const int channels = surface.color_bytes == kSampleColorBytes ? 3 : 4;
  const RopRule* last = nullptr;
  OperationCounts cost;  // of a sample
  accesses.clear();
  for (std::size_t i = 0; i < fragments.list.size(); ++i) {
    const SampleFragment& fragment = fragments.list[i];
    const RopRule& rule = rules.of(triangles, fragment.triangle);
    if (&rule != last) last = &rule, cost = stored_color_cost(rule, channels);
    const std::uint32_t cell = cell_number(fragment, tile, grid);
    PixelObserver* const observer = observer_at(surface.observers, cell / cells);
    const std::size_t first = cell % cells * samples;
    for (std::uint32_t rest = fragment.mask; rest != 0; rest &= rest - 1) {
      const auto s = static_cast<std::size_t>(std::countr_zero(rest));
      const std::size_t at = cell * samples + s;
      if (observer) {
        const BlendParts parts =
            rule.blend ? blend_parts(*rule.blend, fragments.colors[i], surface.color[at]) : BlendParts{};
        observer->blends(fragment.triangle, first + s, parts.added, parts.kept, glm::vec3(fragments.colors[i]));
      }
      surface.color[at] = stored_color(rules, rule, fragments.colors[i], surface.color[at],
                                       [&](float channel) { return rounded_to(surface.format, channel); });
      surface.is_drawn[at] = true;
    }
    const auto written = static_cast<std::uint64_t>(std::popcount(fragment.mask));
    const std::uint64_t read = rule.blend ? written : 0;
    counters.items_in += written;
    counters.items_out += written;
    counters.ops += cost * written;
    counters.bytes_read += kSampleFragmentBytes + read * surface.color_bytes;
    counters.bytes_written += written * surface.color_bytes;
    counters.lanes_used += written;
    counters.lanes_issued += samples;
    accesses.push_back({cell, fragment.triangle, read > 0 ? fragment.mask : 0, fragment.mask});
  }
}

}  // namespace beampipe
