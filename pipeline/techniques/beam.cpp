// The beam in near-first order: each bin's triangles are sorted near to far, roughly; then one pass over them composes
// each pixel. A pixel pays for the edges that it has: it has a word, and where surfaces share it a record in a pool.
// Frames that need the API's order are drawn in it, and pixels keep regions (stages/beam/compose_regions.h).
#include "pipeline/bins/render_bins.h"
#include "pipeline/technique_table.h"
#include "pipeline/units/fragment_units.h"
#include "pipeline/units/pooled_unit.h"
#include "pipeline/units/raster_units.h"
#include "pipeline/units/regions_unit.h"
#include "stages/data/mask_words.h"

namespace beampipe {
namespace {

struct BeamOptions {
  int positions = 256;  // of the mask
  int pool = 40;        // bytes for each pixel of the bin
  int bin = kBinSize;   // pixels on each side
  OwnerShading shading = {};
  AlphaPlaces alpha = AlphaPlaces::sixteenths;
};

Framebuffer beam_framebuffer(const BeamOptions& beam) {
  return {.surfaces = pooled_pixel_surfaces(beam.pool), .place = Place::on_chip, .bin_size = beam.bin};
}

// Surfaces are shaded where triangles cover pixels, whatever OwnerPlace says.
FrameResult render_in_api_order(const FrameContext& context, const BeamOptions& beam,
                                const BeamFragmentOptions& options) {
  const PositionSet& positions = cell_positions(beam.positions);
  const BinPlan plan{.stages = {StageId::conservative_raster, StageId::beam_fragment, StageId::compose, StageId::shade,
                                StageId::resolve},
                     .framebuffer = beam_framebuffer(beam),
                     .keeps_tile_size = true};
  return render_bins(context, plan, [&](Bin& bin) {
    ConservativeRasterUnit raster(bin, "", PairDepths::bounds, ConservativeRasterUnit::Hidden::kept);
    BeamFragmentUnit make_fragments(bin, options);
    ShadeUnit shade(bin);
    ComposeRegionsUnit compose(bin, positions, beam.pool);
    raster.queued(bin.list,
                  [&](const std::vector<Pair>& pairs, std::size_t) { compose(make_fragments.queued(pairs), shade); });
    bin.finish(compose.resolve_regions());
  });
}

template <std::size_t Words>
FrameResult render_words(const FrameJob& job, const BeamOptions& beam) {
  const FrameContext context(job, {.takes_positions = true}, DrawOrder::of_api);
  const PositionSet& positions = cell_positions(beam.positions);
  const PositionGrid grid(beam.positions);
  BeamFragmentOptions options = grid_options(grid, owners_fragment_bytes(Words), kOwnersWholeFragmentBytes);
  options.alpha = beam.alpha;
  if (context.rop) return render_in_api_order(context, beam, options);
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
    ComposePooledUnit<Words> compose(bin,
                                     owners_bin(bin, positions, ordered.triangles, &ordered.watermarks, beam.shading),
                                     {.bytes_per_pixel = beam.pool});

    raster.queued(ordered.triangles, [&](const std::vector<Pair>& pairs, std::size_t first) {
      compose(make_fragments.queued(pairs), first, raster.closed(), shade);
    });
    bin.finish(compose.resolve_owners(shade));
  });
}

FrameResult render_beam(const FrameJob& job, const BeamOptions& beam) {
  return with_words<1, 2, 4, 8>(beam.positions, [&]<std::size_t Words>() { return render_words<Words>(job, beam); });
}

}  // namespace

TechniqueKind beam_kind() {
  return {
      .name = "beam",
      .variant = {"order", "near-first"},
      .description =
          "fragments with analytic coverage and a mask, taken near to far in each bin; a pixel has a word, and where "
          "surfaces share it a record in the bin's pool, until nothing nearer can hide them any more",
      .source = "ours, after Crassin et al. 2018",
      .examples = {"beam", "beam:bits=128,pool=30,at=visible", "beam:bits=32,pool=16,bin=8,at=quarters",
                   "beam:at=covered,alpha=256,filter=sampler"},
      .texture_taps = 16,
      .stressed = {"beam", "beam:bits=128,pool=16"},
      .counters = {"memory_chunks", "merges", "collections", "pool_bytes", "record_bytes", "shadings"},
      .make = make_from(
          BeamOptions{},
          [](BeamOptions& o) -> SpecOptions {
            return {
                choice("bits", o.positions, {{"32", 32}, {"64", 64}, {"128", 128}, {"256", 256}},
                       "positions of the mask"),
                choice("pool", o.pool,
                       {{"16", 16}, {"24", 24}, {"30", 30}, {"40", 40}, {"60", 60}, {"80", 80}, {"128", 128}},
                       "bytes on chip for each pixel of the bin, which records share; beyond that, records lie in "
                       "memory"),
                choice("at", o.shading.at,
                       {{"covered", OwnerPlace::covered},
                        {"visible", OwnerPlace::visible},
                        {"quarters", OwnerPlace::quarters},
                        {"sixteenths", OwnerPlace::sixteenths},
                        {"adaptive", OwnerPlace::adaptive}},
                       "shading point of a surface with a material: the centroid of what its triangle covers, of its "
                       "own positions, or of its positions in each quarter or sixteenth of the pixel; or as many of "
                       "these as light needs, with textures filtered over the positions"),
                beside(
                    "at=adaptive", [&o] { return o.shading.at == OwnerPlace::adaptive; },
                    number("tolerance", o.shading.tolerance, 0, 1000,
                           "how far light may vary, times the share of the pixel, where it is shaded once")),
                choice("alpha", o.alpha,
                       {{"1", AlphaPlaces::one},
                        {"4", AlphaPlaces::quarters},
                        {"16", AlphaPlaces::sixteenths},
                        {"256", AlphaPlaces::all}},
                       "places of a pixel where the texture of a cutout is looked up first; 256: at each position"),
                choice("bin", o.bin, {{"8", 8}, {"16", 16}, {"32", 32}}, "pixels on each side of a bin")};
          },
          [](const BeamOptions& o) {
            return Technique{.framebuffer = beam_framebuffer(o),
                             .positions = o.positions,
                             .counted_positions = o.positions,
                             .renderer = bind_options(render_beam, o),
                             .is_observable = true,
                             .has_weights = true,
                             .keeps_api_order = true};
          })};
}

}  // namespace beampipe
