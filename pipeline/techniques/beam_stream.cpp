// The beam in streaming order, as immediate-mode hardware works: fragments come in primitive order, without an A-buffer
// or any memory per fragment. A pixel keeps only its state.
//
// In one pass, a pixel that has more owners than slots makes one of two (stages/data/open_pixel.h). In several passes
// (stages/data/owner_pixel.h), it takes further passes over the geometry; each settles the nearest surfaces that are
// left.
#include <stdexcept>

#include "pipeline/bins/render_bins.h"
#include "pipeline/technique_table.h"
#include "pipeline/units/fragment_units.h"
#include "pipeline/units/layer_units.h"
#include "pipeline/units/owner_units.h"
#include "pipeline/units/raster_units.h"

namespace beampipe {
namespace {

struct StreamOptions {
  int positions = 128;  // 32, 64, 128 or 256
  int passes = 1;       // the most passes; 0: until every pixel is settled
  int slots = 7;        // in one pass: owners of a pixel
  int layers = 5;       // in several passes: 1 or 5
};

Framebuffer stream_framebuffer(const StreamOptions& stream) {
#define BEAMPIPE_SURFACES(words, pixel_slots)                                              \
  if (stream.passes == 1 && stream.positions == 32 * words && stream.slots == pixel_slots) \
    return {.surfaces = open_pixel_surfaces<words, pixel_slots>()};
  BEAMPIPE_OPEN_PIXELS(BEAMPIPE_SURFACES)
#undef BEAMPIPE_SURFACES
  const auto words = static_cast<std::uint32_t>(stream.positions / 32),
             layers = static_cast<std::uint32_t>(stream.layers);
  const std::uint32_t state_bytes = 4 * words * (layers == 1 ? 2 : 3);
  return {.surfaces = {{"owner_map", times("R32UI", state_bytes / 4), state_bytes},
                       {"owners", times("R32UI", layers), 4 * layers},
                       {"dropped_depth", "R32F", 4},
                       {"color", "RGB16F + R16", 8}}};
}

template <std::size_t Words, std::size_t Slots>
FrameResult render_one_pass(const Trace& trace, const Frame& frame, const StreamOptions& stream,
                            const RunOptions& run) {
  const FrameContext context(trace, frame, run, {.takes_positions = true});
  const PositionSet& positions = cell_positions(stream.positions);
  const PositionGrid grid(stream.positions);
  const BeamFragmentOptions options = grid_options(grid, owners_fragment_bytes(Words));
  const BinPlan plan{.stages = {"conservative_raster", "beam_fragment", "compose", "shade", "resolve"},
                     .framebuffer = stream_framebuffer(stream)};
  return render_bins(context, plan, [&](Bin& bin) {
    ConservativeRasterUnit raster(bin, "", PairDepths::bounds, ConservativeRasterUnit::Hidden::left_out);
    BeamFragmentUnit make_fragments(bin, options);
    ShadeUnit shade(bin);
    bin.triangle_fetches().load_setup();
    ComposeOwnersUnit<Words, Slots> compose(bin, positions, bin.list, nullptr, plan.framebuffer.surfaces);

    raster.queued(bin.list, [&](const std::vector<Pair>& pairs, std::size_t first) {
      compose(make_fragments.queued(pairs), first, raster.closed(), shade);
    });
    bin.finish(compose.resolve_owners(shade));
    shade.finish_fetches();
  });
}

template <std::size_t Words, std::size_t Layers>
FrameResult render_passes(const Trace& trace, const Frame& frame, const StreamOptions& stream, const RunOptions& run) {
  const FrameContext context(trace, frame, run, {.takes_positions = true});
  const PositionSet& positions = cell_positions(stream.positions);
  const PositionGrid grid(stream.positions);
  const BeamFragmentOptions options = grid_options(grid, streaming_fragment_bytes(Words));
  const BinPlan plan{.stages = {"conservative_raster", "beam_fragment", "claim", "shade", "settle", "resolve"},
                     .framebuffer = stream_framebuffer(stream)};
  return render_bins(context, plan, [&](Bin& bin) {
    ConservativeRasterUnit raster(bin, "batch_pairs", PairDepths::bounds, ConservativeRasterUnit::Hidden::left_out);
    BeamFragmentUnit make_fragments(bin, options);
    OwnersUnit<Words, Layers> pixels(bin, positions, plan.framebuffer.surfaces);
    ShadeUnit shade(bin);
    std::vector<float>& counts = bin.pixel_counter("fragments");

    Tile box = bin.tile;
    for (int pass = 1; box.x0 < box.x1; ++pass) {
      if (pass > 1) raster.start_next_pass();
      pixels.start_pass();
      for_each_batch(bin.list, [&](const TriangleList& batch) {
        const std::vector<Fragment>& fragments = make_fragments(raster(batch, box), "batch_fragments");
        if (pass == 1) count_by_pixel(fragments, counts);
        pixels.claim_positions(fragments);
      });
      std::vector<Fragment>& owned = make_fragments.fetched(pixels.finish_claims(), "owner_fragments");
      shade.visible(owned);
      shade.finish_fetches();
      pixels.settle_positions(owned, pass == stream.passes, raster.closed());
      box = pixels.unfinished();
      if (box.x0 < box.x1) pixels.store_closed(raster.closed());
    }
    bin.finish(pixels.resolve_settled());
  });
}

FrameResult render_stream(const Trace& trace, const Frame& frame, const StreamOptions& stream, const RunOptions& run) {
#define BEAMPIPE_RENDER(words, pixel_slots)                                                \
  if (stream.passes == 1 && stream.positions == 32 * words && stream.slots == pixel_slots) \
    return render_one_pass<words, pixel_slots>(trace, frame, stream, run);
  BEAMPIPE_OPEN_PIXELS(BEAMPIPE_RENDER)
#undef BEAMPIPE_RENDER
#define BEAMPIPE_RENDER(words, pixel_layers)                                                 \
  if (stream.passes != 1 && stream.positions == 32 * words && stream.layers == pixel_layers) \
    return render_passes<words, pixel_layers>(trace, frame, stream, run);
  BEAMPIPE_OWNER_PIXELS(BEAMPIPE_RENDER)
#undef BEAMPIPE_RENDER
  throw std::invalid_argument("no pixel of this shape");
}

}  // namespace

TechniqueKind beam_stream_kind() {
  return {
      .name = "beam",
      .variant = {"order", "stream", "near-first"},
      .description =
          "fragments in primitive order, without an A-buffer, bins or a sort; of more owners than a pixel has slots "
          "for, two become one, or the pixel takes further passes over the geometry",
      .source = "ours",
      .make = make_from(
          StreamOptions{},
          [](StreamOptions& o) -> SpecOptions {
            return {
                choice("bits", o.positions, {{"32", 32}, {"64", 64}, {"128", 128}, {"256", 256}},
                       "positions of the mask"),
                number("passes", o.passes, 0, 1000, "most passes over the geometry; 0: until every pixel is settled"),
                beside(
                    "passes=1", [&o] { return o.passes == 1; },
                    choice("slots", o.slots, {{"2", 2}, {"4", 4}, {"5", 5}, {"7", 7}, {"8", 8}, {"16", 16}, {"32", 32}},
                           "in one pass: owners that a pixel keeps at once")),
                beside(
                    "passes=0 or more than one pass", [&o] { return o.passes != 1; },
                    choice("layers", o.layers, {{"1", 1}, {"5", 5}},
                           "in several passes: surfaces that a pixel keeps at once"))};
          },
          [](const StreamOptions& o) {
            return Technique{.framebuffer = stream_framebuffer(o),
                             .render = bind_options(render_stream, o),
                             .is_observable = o.passes == 1,
                             .has_weights = o.passes == 1};
          })};
}

}  // namespace beampipe
