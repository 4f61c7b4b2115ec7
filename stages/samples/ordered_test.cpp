#include "stages/samples/ordered_test.h"

#include <algorithm>
#include <bit>

#include "simd/depth_compare.h"
#include "stages/samples/ordered_test_cost.h"

namespace beampipe {
namespace {

// The state of the draw at hand, and what its samples came to.
class RuleTally {
 public:
  explicit RuleTally(StageCounters& counters) : counters_(counters) {}
  ~RuleTally() { charge(); }

  TestedSamples& start(const RopRule& rule, const Stencil& stencil) {
    if (&rule != rule_ || &stencil != stencil_) {
      charge();
      rule_ = &rule, stencil_ = &stencil, samples_ = {};
    }
    return samples_;
  }

 private:
  void charge() {
    if (rule_) counters_.ops += ordered_test_cost(*rule_, *stencil_, samples_);
  }

  StageCounters& counters_;
  const RopRule* rule_ = nullptr;
  const Stencil* stencil_ = nullptr;
  TestedSamples samples_;
};

void clear(const RopRules& rules, const RopClear& what, OrderedTile& surface) {
  if (what.depth) std::fill(surface.depth.begin(), surface.depth.end(), rules.clear_depth);
  if (what.stencil) std::fill(surface.stencil.begin(), surface.stencil.end(), static_cast<std::uint8_t>(*what.stencil));
}

}  // namespace

void ordered_test(const SampledTriangles& in, const RopRules& rules, StageCounters& counters, OrderedTile& surface,
                  std::vector<SampleFragment>& fragments, std::vector<OrderedAccess>& accesses) {
  const auto& [triangles, tile, sampling] = in;
  const CellGrid& grid = sampling.grid;
  const double cell_width = 1.0 / grid.columns, cell_height = 1.0 / grid.rows;  // pixels; exact
  const auto samples = static_cast<std::size_t>(sampling.pattern.count),
             cells = static_cast<std::size_t>(grid.cells_per_pixel());
  RuleTally tally(counters);
  accesses.clear();
  counters.ops += cell_plane_cost() * fragments.size();
  std::size_t left = 0;
  for (const SampleFragment& fragment : fragments) {
    rules.clear_before(triangles.draws[fragment.triangle], surface.next_clear,
                       [&](const RopClear& what) { clear(rules, what, surface); });
    const RopRule& rule = rules.of(triangles, fragment.triangle);
    const SetupTriangle& triangle = triangles.triangles[fragment.triangle];
    const Stencil& stencil = rule.stencil_of(triangle);
    TestedSamples& count = tally.start(rule, stencil);
    const std::uint32_t cell = cell_number(fragment, tile, grid);
    const CellPlane<float> plane = cell_plane(triangle.depth, fragment.x * cell_width, fragment.y * cell_height);
    std::uint32_t passed = 0, written = 0;
    for (std::uint32_t rest = fragment.mask; rest != 0; rest &= rest - 1) {
      const auto s = static_cast<std::size_t>(std::countr_zero(rest));
      const std::size_t at = cell * samples + s;
      const auto update = [&](StencilOperation operation) {
        if (!rule.has_stencil) return;
        const std::uint32_t old = surface.stencil[at], now = stencil_after(operation, stencil, old);
        surface.stencil[at] = static_cast<std::uint8_t>(now);
        if (operation != StencilOperation::keep && stencil.write_mask != 0) written |= 1u << s;
      };
      ++count.tested;
      if (rule.has_stencil && !stencil_passes(stencil, std::uint32_t{surface.stencil[at]})) {
        ++count.stencil_failed;
        update(stencil.fail);
        continue;
      }
      float depth = 0;
      depth_test_scalar(plane, static_cast<float>(sampling.pattern.x[s]), static_cast<float>(sampling.pattern.y[s]),
                        0.0f, depth);
      depth = std::clamp(fragment.depth.value_or(depth), static_cast<float>(rule.nearest),
                         static_cast<float>(rule.farthest));
      if (!passes(rule.depth, depth, surface.depth[at])) {
        ++count.depth_failed;
        update(stencil.depth_fail);
        continue;
      }
      ++count.passed;
      update(stencil.pass);
      passed |= 1u << s;
      if (!rule.writes_depth) continue;
      written |= 1u << s;
      surface.depth[at] = depth;
    }
    const std::uint32_t read = rule.tests() ? fragment.mask : 0;
    const auto number_of = [](std::uint32_t mask) { return static_cast<std::uint64_t>(std::popcount(mask)); };
    counters.items_in += number_of(fragment.mask);
    counters.items_out += number_of(passed);
    counters.lanes_used += number_of(fragment.mask);
    counters.lanes_issued += samples;
    counters.bytes_read += kSampleFragmentBytes + number_of(read) * kSampleDepthBytes;
    counters.bytes_written += number_of(written) * kSampleDepthBytes;
    if (read != 0 || written != 0) accesses.push_back({cell, fragment.triangle, read, written});
    const std::size_t pixel = cell / cells;
    if (PixelObserver* const observer = observer_at(surface.observers, pixel))
      observer->contends(fragment.triangle, cell % cells * samples, fragment.mask & ~passed, 0);
    if (passed == 0 || !rule.writes_color()) continue;
    fragments[left] = fragment;
    fragments[left++].mask = passed;
  }
  fragments.resize(left);
}

}  // namespace beampipe
