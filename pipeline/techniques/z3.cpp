// Z3 (Jouppi and Chang 1999), an earlier way to do without an A-buffer. Fragments go in primitive order into a few
// layers per pixel; when there are too many, two layers are merged (stages/beam/compose_z3.h).
#include <stdexcept>
#include <string>

#include "pipeline/bins/render_bins.h"
#include "pipeline/technique_table.h"
#include "pipeline/units/fragment_units.h"
#include "pipeline/units/layer_units.h"
#include "pipeline/units/raster_units.h"
#include "stages/beam/compose_z3.h"

namespace beampipe {
namespace {

struct Z3Options {
  int positions = 32;  // together with `layers` one of BEAMPIPE_Z3_PIXELS
  int layers = 3;
  LayerMerge merge = LayerMerge::depth;
};

Framebuffer z3_framebuffer(const Z3Options& z3) {
  const auto words = static_cast<std::uint32_t>(z3.positions / 32), layers = static_cast<std::uint32_t>(z3.layers);
  return {.surfaces = {{"owner_map", times("R32UI", 2 * words), 8 * words},
                       {"depth", times("R32F", layers), 4 * layers},
                       {"slopes", times("RG16BF", layers), 4 * layers},
                       {"color", times("RGB16F", layers), 6 * layers}}};
}

template <std::size_t Words, std::size_t Layers>
FrameResult render_shape(const Trace& trace, const Frame& frame, const Z3Options& z3, const RunOptions& run) {
  const FrameContext context(trace, frame, run, {.takes_positions = true});
  const PositionSet& positions = cell_positions(z3.positions);
  const PositionGrid grid(z3.positions);
  const BeamFragmentOptions options = grid_options(grid, 4 + 4 * Words + 12);
  const BinPlan plan{.stages = {"conservative_raster", "beam_fragment", "shade", "compose", "resolve"},
                     .framebuffer = z3_framebuffer(z3)};
  return render_bins(context, plan, [&](Bin& bin) {
    ConservativeRasterUnit raster(bin, "pair_queue", PairDepths::bounds, ConservativeRasterUnit::Hidden::kept,
                                  kQueueItems);
    BeamFragmentUnit make_fragments(bin, options);
    ShadeUnit shade(bin);
    ComposeZ3Unit<Words, Layers> compose(bin, positions, z3.merge, plan.framebuffer.surfaces);
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

FrameResult render_z3(const Trace& trace, const Frame& frame, const Z3Options& z3, const RunOptions& run) {
#define BEAMPIPE_RENDER(words, shape_layers)                   \
  if (z3.positions == 32 * words && z3.layers == shape_layers) \
    return render_shape<words, shape_layers>(trace, frame, z3, run);
  BEAMPIPE_Z3_PIXELS(BEAMPIPE_RENDER)
#undef BEAMPIPE_RENDER
  throw std::invalid_argument("no pixel of this shape: " + std::to_string(z3.positions) + " positions, " +
                              std::to_string(z3.layers) + " layers");
}

}  // namespace

TechniqueKind z3_kind() {
  struct Shape {
    int positions, layers;
    bool operator==(const Shape&) const = default;
  };
  struct Z3Spec {
    Shape shape{Z3Options{}.positions, Z3Options{}.layers};
    LayerMerge merge = Z3Options{}.merge;
  };
  return {.name = "z3",
          .description =
              "fragments in primitive order, kept in a few layers per pixel; when there is no room, two layers merge",
          .source = "Jouppi and Chang 1999",
          .make = make_from(
              Z3Spec{},
              [](Z3Spec& o) -> SpecOptions {
                return {choice("shape", o.shape, {{"32x2", {32, 2}}, {"32x3", {32, 3}}, {"128x3", {128, 3}}},
                               "positions of the mask x layers"),
                        choice("merge", o.merge, {{"depth", LayerMerge::depth}, {"color", LayerMerge::color}},
                               "the two layers that merge are the closest in depth (as published), or in colour")};
              },
              [](const Z3Spec& o) {
                const Z3Options options{o.shape.positions, o.shape.layers, o.merge};
                return Technique{.framebuffer = z3_framebuffer(options),
                                 .render = bind_options(render_z3, options),
                                 .is_observable = true};
              })};
}

}  // namespace beampipe
