#include "pipeline/units/ordered_unit.h"

#include <algorithm>

#include "pipeline/units/fragment_units.h"
#include "pipeline/units/raster_units.h"
#include "stages/samples/ordered_blend.h"
#include "stages/samples/ordered_test.h"

namespace beampipe {
namespace {

bool has_stencil(const RopRules& rules) {
  return std::ranges::any_of(rules.draws, [](const auto& rules_of_draw) { return rules_of_draw[0].has_stencil; });
}

std::size_t samples_of(const Sampling& sampling) {
  return static_cast<std::size_t>(sampling.grid.cells_per_pixel() * sampling.pattern.count);
}

}  // namespace

OrderedUnit::OrderedUnit(Bin& bin, const Sampling& sampling, AccumulatorFormat format, std::uint32_t color_bytes)
    : bin_(bin),
      sampling_(sampling),
      surface_(bin.tile, samples_of(sampling), bin.context.rop->clear_depth, has_stencil(*bin.context.rop),
               bin.context.rop->clear_color),
      memory_(bin.memory(), bin.tile, sampling, color_bytes,
              [&shader = bin.context.shader](std::uint32_t a, std::uint32_t b) { return shader.same_color(a, b); }) {
  surface_.format = format;
  surface_.color_bytes = color_bytes;
  surface_.observers = bin.observers();
}

void OrderedUnit::draw(ShadeAt at, AlphaCoverage alpha) {
  const RopRules& rules = *bin_.context.rop;
  const SampledTriangles in{bin_.triangles(), bin_.tile, sampling_};
  const BinStage testing = bin_.stage(StageId::depth_test), blending = bin_.stage(StageId::blend);
  SampleShadeUnit shade(bin_, sampling_, at, surface_.color_bytes);
  shade.counts_centroids();
  SampleRasterUnit raster(bin_, SampleRasterUnit::Translucent::drawn, alpha);
  raster.keeps_hidden();
  std::vector<OrderedAccess> accesses;
  raster.pass(sampling_, at, [&](std::vector<SampleFragment>& fragments) {
    count_by_pixel(fragments, bin_.tile, sampling_.grid, bin_.pixel_counter("fragments"));
    ordered_test(in, rules, testing.timed(), surface_, fragments, accesses);
    memory_.test_in_order(accesses, testing.counters);
    raster.test_alpha_after_tests(sampling_, at);
    const std::vector<glm::vec4> colors = shade.colors(fragments);
    ordered_blend(in, rules, {fragments, colors}, blending.timed(), surface_, accesses);
    memory_.blend_in_order(accesses, blending.counters);
  });
  memory_.flush(blending.counters);
  if (bin_.models_memory()) memory_.add_bytes(bin_.pixel_counter("bytes"));
}

std::vector<glm::vec4> OrderedUnit::resolve_samples(ResolveSpace space) {
  StageCounters nothing_is_moved;
  const auto resolved = [&](StageCounters& counters) {
    return resolve(surface_, bin_.tile.pixels(), bin_.background(), space, counters);
  };
  if (!bin_.resolves()) return resolved(nothing_is_moved);
  const BinStage resolving = bin_.stage(StageId::resolve);
  memory_.read_color(resolving.counters);
  return resolved(resolving.timed());
}

}  // namespace beampipe
