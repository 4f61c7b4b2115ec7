// Z3 (Jouppi and Chang 1999), an earlier way to do without an A-buffer. Fragments go in primitive order into a few
// layers per pixel; when there are too many, two layers are merged (stages/beam/compose_z3.h).

#include "pipeline/bins/render_bins.h"
#include "pipeline/sampling.h"
#include "pipeline/technique_table.h"
#include "pipeline/units/fragment_units.h"
#include "pipeline/units/raster_units.h"
#include "pipeline/units/z3_unit.h"
#include "stages/data/mask_words.h"

namespace beampipe {
namespace {

struct Z3Options {
  int positions = 32;
};

Framebuffer z3_framebuffer(const Z3Options& z3) {
  const auto words = static_cast<std::uint32_t>(z3.positions / 32);
  constexpr std::uint32_t layers = kZ3Layers;
  return {.surfaces = {{"owner_map", times("R32UI", 2 * words), 8 * words},
                       {"depth", times("R32F", layers), 4 * layers},
                       {"slopes", times("RG16BF", layers), 4 * layers},
                       {"color", times("RGB16F", layers), 6 * layers}}};
}

template <std::size_t Words>
FrameResult render_words(const FrameJob& job, const Z3Options& z3) {
  const FrameContext context(job, {.takes_positions = true});
  const PositionSet& positions = cell_positions(z3.positions);
  const PositionGrid grid(z3.positions);
  const BeamFragmentOptions options = grid_options(grid, 4 + 4 * Words + 12);
  const BinPlan plan{.stages = {StageId::conservative_raster, StageId::beam_fragment, StageId::shade, StageId::compose,
                                StageId::resolve},
                     .framebuffer = z3_framebuffer(z3)};
  return render_bins(context, plan, [&](Bin& bin) {
    ConservativeRasterUnit raster(bin, "pair_queue", PairDepths::bounds, ConservativeRasterUnit::Hidden::kept,
                                  kQueueItems);
    BeamFragmentUnit make_fragments(bin, options);
    ShadeUnit shade(bin);
    ComposeZ3Unit<Words> compose(bin, positions, plan.framebuffer.surfaces);
    std::vector<float>& counts = bin.pixel_counter("fragments");

    for_each_batch(bin.list, [&](const TriangleList& batch) {
      std::vector<Fragment>& fragments = make_fragments.queued(raster(batch, bin.tile));
      count_by_pixel(fragments, counts);
      shade(fragments);
      compose(fragments);
    });
    bin.finish(compose.resolve_layers());
  });
}

FrameResult render_z3(const FrameJob& job, const Z3Options& z3) {
  return with_words<1, 4>(z3.positions, [&]<std::size_t Words>() { return render_words<Words>(job, z3); });
}

}  // namespace

TechniqueKind z3_kind() {
  return {.name = "z3",
          .description =
              "fragments in primitive order, kept in a few layers per pixel; when layers run out, two are merged",
          .source = "Jouppi and Chang 1999",
          .examples = {"z3", "z3:shape=128x3"},
          .stressed = {"z3", "z3:shape=128x3"},
          .counters = {"merges"},
          .make = make_from(
              Z3Options{},
              [](Z3Options& o) -> SpecOptions {
                return {choice("shape", o.positions, {{"32x3", 32}, {"128x3", 128}}, "positions of the mask x layers")};
              },
              [](const Z3Options& o) {
                return Technique{.framebuffer = z3_framebuffer(o),
                                 .sampled_at = places_of(cell_patterns(o.positions)),
                                 .positions = o.positions,
                                 .errs_by = {ErrorSource::merges_of_layers},
                                 .renderer = bind_options(render_z3, o),
                                 .is_observable = true};
              })};
}

}  // namespace beampipe
