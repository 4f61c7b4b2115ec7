// The beam in near-first order: each bin's triangles are sorted near to far, roughly; then one pass over them composes
// each pixel in a state of fixed size. Nothing waits, and nothing is kept per fragment.
#include <algorithm>
#include <stdexcept>
#include <string>

#include "pipeline/bins/render_bins.h"
#include "pipeline/technique_table.h"
#include "pipeline/units/fragment_units.h"
#include "pipeline/units/owner_units.h"
#include "pipeline/units/raster_units.h"

namespace beampipe {
namespace {

struct BeamOptions {
  int positions = 256;  // of the mask: 32, 64, 128 or 256
  int slots = 5;        // owners of a pixel
  int bin = kBinSize;   // pixels on each side
  OwnerPlace shade_at = OwnerPlace::covered;
};

Framebuffer beam_framebuffer(const BeamOptions& beam) {
  Framebuffer framebuffer{.place = Place::on_chip, .bin_size = beam.bin};
#define BEAMPIPE_SURFACES(words, pixel_slots)                    \
  if (beam.positions == 32 * words && beam.slots == pixel_slots) \
    framebuffer.surfaces = open_pixel_surfaces<words, pixel_slots>();
  BEAMPIPE_OPEN_PIXELS(BEAMPIPE_SURFACES)
#undef BEAMPIPE_SURFACES
  return framebuffer;
}

template <std::size_t Words, std::size_t Slots>
FrameResult render_shape(const Trace& trace, const Frame& frame, const BeamOptions& beam, const RunOptions& run) {
  const FrameContext context(trace, frame, run, {.takes_positions = true});
  const PositionSet& positions = cell_positions(beam.positions);
  const PositionGrid grid(beam.positions);
  const BeamFragmentOptions options = grid_options(grid, owners_fragment_bytes(Words));
  const BinPlan plan{.stages = {"conservative_raster", "bin_sort", "beam_fragment", "compose", "shade", "resolve"},
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

FrameResult render_beam(const Trace& trace, const Frame& frame, const BeamOptions& beam, const RunOptions& run) {
#define BEAMPIPE_RENDER(words, pixel_slots)                      \
  if (beam.positions == 32 * words && beam.slots == pixel_slots) \
    return render_shape<words, pixel_slots>(trace, frame, beam, run);
  BEAMPIPE_OPEN_PIXELS(BEAMPIPE_RENDER)
#undef BEAMPIPE_RENDER
  throw std::invalid_argument("no pixel of this shape: " + std::to_string(beam.positions) + " positions, " +
                              std::to_string(beam.slots) + " slots");
}

}  // namespace

TechniqueKind beam_kind() {
  return {.name = "beam",
          .description =
              "each bin's triangles, sorted near to far, become fragments with analytic coverage and a mask; a pixel "
              "keeps the owners of its mask positions until nothing nearer can come, in a state of fixed size",
          .source = "ours, after Crassin et al. 2018",
          .make = make_from(
              BeamOptions{},
              [](BeamOptions& o) -> SpecOptions {
                return {
                    choice("bits", o.positions, {{"32", 32}, {"64", 64}, {"128", 128}, {"256", 256}},
                           "positions of the mask"),
                    choice("slots", o.slots, {{"2", 2}, {"4", 4}, {"5", 5}, {"7", 7}, {"8", 8}, {"16", 16}, {"32", 32}},
                           "owners that a pixel keeps at once; if there are more, two become one"),
                    choice("at", o.shade_at,
                           {{"covered", OwnerPlace::covered},
                            {"visible", OwnerPlace::visible},
                            {"quarters", OwnerPlace::quarters},
                            {"sixteenths", OwnerPlace::sixteenths}},
                           "where an owner is shaded that is not flat: at the centroid of what its triangle covers, of "
                           "its positions, or of its positions in each quarter or sixteenth of the pixel"),
                    choice("bin", o.bin, {{"8", 8}, {"16", 16}, {"32", 32}}, "pixels on each side of a bin")};
              },
              [](const BeamOptions& o) {
                return Technique{.framebuffer = beam_framebuffer(o),
                                 .render = bind_options(render_beam, o),
                                 .is_observable = true,
                                 .has_weights = true};
              })};
}

}  // namespace beampipe
