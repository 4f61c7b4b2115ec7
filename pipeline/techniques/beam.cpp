// The beam in near-first order: each bin's triangles are sorted near to far, roughly; then one pass over them composes
// each pixel in a state of fixed size. Nothing waits, and nothing is kept per fragment.
#include <algorithm>

#include "pipeline/bins/render_bins.h"
#include "pipeline/technique_table.h"
#include "pipeline/units/fragment_units.h"
#include "pipeline/units/owner_units.h"
#include "pipeline/units/raster_units.h"

namespace beampipe {
namespace {

struct BeamOptions {
  int positions = 256;  // of the mask; together with `slots` one of BEAMPIPE_OPEN_PIXELS
  int slots = 5;        // owners of a pixel
  int bin = kBinSize;   // pixels on each side
  OwnerPlace shade_at = OwnerPlace::covered;
};

Framebuffer beam_framebuffer(const BeamOptions& beam) {
  return {.surfaces = open_pixel_surfaces(beam.positions, beam.slots), .place = Place::on_chip, .bin_size = beam.bin};
}

template <std::size_t Words, std::size_t Slots>
FrameResult render_shape(const FrameJob& job, const BeamOptions& beam) {
  const FrameContext context(job, {.takes_positions = true});
  const PositionSet& positions = cell_positions(beam.positions);
  const PositionGrid grid(beam.positions);
  const BeamFragmentOptions options = grid_options(grid, owners_fragment_bytes(Words));
  const BinPlan plan{.stages = {StageId::bin_sort, StageId::conservative_raster, StageId::beam_fragment,
                                StageId::compose, StageId::shade, StageId::resolve},
                     .framebuffer = beam_framebuffer(beam),
                     .keeps_tile_size = true,
                     .sorts_lists = true,
                     .order = kNearFirstOrder};
  return render_bins(context, plan, [&](Bin& bin) {
    const OrderedList ordered = sort_bin(bin);
    ConservativeRasterUnit raster(bin, "", PairDepths::bounds, ConservativeRasterUnit::Hidden::left_out);
    BeamFragmentUnit make_fragments(bin, options);
    ShadeUnit shade(bin);
    ComposeOwnersUnit<Words, Slots> compose(bin, positions, ordered.triangles, &ordered.watermarks,
                                            plan.framebuffer.surfaces, beam.shade_at);

    raster.queued(ordered.triangles, [&](const std::vector<Pair>& pairs, std::size_t first) {
      compose(make_fragments.queued(pairs), first, raster.closed(), shade);
    });
    bin.finish(compose.resolve_owners(shade));
    shade.finish_fetches();
  });
}

FrameResult render_beam(const FrameJob& job, const BeamOptions& beam) {
  return with_shape(beam.positions, beam.slots,
                    [&]<std::size_t Words, std::size_t Slots>() { return render_shape<Words, Slots>(job, beam); });
}

}  // namespace

TechniqueKind beam_kind() {
  return {
      .name = "beam",
      .variant = {"order", "near-first"},
      .description =
          "fragments with analytic coverage and a mask, taken near to far in each bin; a pixel keeps up to five "
          "surfaces and retires those that nothing nearer can hide any more, so its state has a fixed size",
      .source = "ours, after Crassin et al. 2018",
      .examples = {"beam", "beam:bits=64,slots=4,at=visible", "beam:bits=32,slots=2,bin=8,at=quarters"},
      .stressed = {"beam", "beam:bits=64,slots=4", "beam:bits=32,slots=2"},
      .make = make_from(
          BeamOptions{},
          [](BeamOptions& o) -> SpecOptions {
            return {
                beside(
                    "slots=2, 4, 8, 16 or 32, unless it is 256", [&o] { return o.positions == 256 || o.slots != 5; },
                    choice("bits", o.positions, {{"32", 32}, {"64", 64}, {"128", 128}, {"256", 256}},
                           "positions of the mask; fewer than 256 need another number of slots than 5")),
                choice("slots", o.slots, {{"2", 2}, {"4", 4}, {"5", 5}, {"8", 8}, {"16", 16}, {"32", 32}},
                       "surfaces that a pixel keeps at once; when slots run out, two surfaces are merged"),
                choice("at", o.shade_at,
                       {{"covered", OwnerPlace::covered},
                        {"visible", OwnerPlace::visible},
                        {"quarters", OwnerPlace::quarters},
                        {"sixteenths", OwnerPlace::sixteenths}},
                       "shading point of a surface with a material: the centroid of what its triangle covers, of its "
                       "own positions, or of its positions in each quarter or sixteenth of the pixel"),
                choice("bin", o.bin, {{"8", 8}, {"16", 16}, {"32", 32}}, "pixels on each side of a bin")};
          },
          [](const BeamOptions& o) {
            return Technique{.framebuffer = beam_framebuffer(o),
                             .positions = o.positions,
                             .counted_positions = o.positions,
                             .renderer = bind_options(render_beam, o),
                             .is_observable = true,
                             .has_weights = true};
          })};
}

}  // namespace beampipe
