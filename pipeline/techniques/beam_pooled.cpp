// The beam in near-first order with pooled state: a pixel pays for the edges that it has. It is meant to replace the
// state of fixed size (beam.cpp), and stands beside it until the two have been compared everywhere.
#include "pipeline/bins/render_bins.h"
#include "pipeline/technique_table.h"
#include "pipeline/units/fragment_units.h"
#include "pipeline/units/pooled_unit.h"
#include "pipeline/units/raster_units.h"

namespace beampipe {
namespace {

struct PooledOptions {
  int positions = 256;  // of the mask
  int pool = 60;        // bytes for each pixel of the bin
  int bin = kBinSize;   // pixels on each side
  OwnerPlace shade_at = OwnerPlace::covered;
};

Framebuffer pooled_framebuffer(const PooledOptions& beam) {
  return {.surfaces = pooled_pixel_surfaces(beam.pool), .place = Place::on_chip, .bin_size = beam.bin};
}

template <std::size_t Words>
FrameResult render_positions(const FrameJob& job, const PooledOptions& beam) {
  const FrameContext context(job, {.takes_positions = true});
  const PositionSet& positions = cell_positions(beam.positions);
  const PositionGrid grid(beam.positions);
  const BeamFragmentOptions options = grid_options(grid, owners_fragment_bytes(Words));
  const BinPlan plan{.stages = {StageId::bin_sort, StageId::conservative_raster, StageId::beam_fragment,
                                StageId::compose, StageId::shade, StageId::resolve},
                     .framebuffer = pooled_framebuffer(beam),
                     .keeps_tile_size = true,
                     .sorts_lists = true,
                     .order = kNearFirstOrder};
  return render_bins(context, plan, [&](Bin& bin) {
    const OrderedList ordered = sort_bin(bin);
    ConservativeRasterUnit raster(bin, "", PairDepths::bounds, ConservativeRasterUnit::Hidden::left_out);
    BeamFragmentUnit make_fragments(bin, options);
    ShadeUnit shade(bin);
    ComposePooledUnit<Words> compose(bin, positions, ordered, plan.framebuffer.surfaces, beam.pool, beam.shade_at);

    raster.queued(ordered.triangles, [&](const std::vector<Pair>& pairs, std::size_t first) {
      compose(make_fragments.queued(pairs), first, raster.closed(), shade);
    });
    bin.finish(compose.resolve_owners(shade));
    shade.finish_fetches();
  });
}

FrameResult render_pooled(const FrameJob& job, const PooledOptions& beam) {
  return with_words(beam.positions, [&]<std::size_t Words>() { return render_positions<Words>(job, beam); });
}

}  // namespace

TechniqueKind beam_pooled_kind() {
  return {
      .name = "beam",
      .variant = {"order", "pooled"},
      .description =
          "near-first order with a word for each pixel, and records of surfaces and masks only where surfaces share a "
          "pixel, in a pool of the bin; a record that finds no room there lies in memory",
      .source = "ours, after Crassin et al. 2018",
      .examples = {"beam:order=pooled", "beam:order=pooled,bits=128,pool=30,at=visible",
                   "beam:order=pooled,bits=32,pool=4,bin=8,at=quarters"},
      .stressed = {"beam:order=pooled", "beam:order=pooled,bits=128,pool=0"},
      .make = make_from(
          PooledOptions{},
          [](PooledOptions& o) -> SpecOptions {
            return {
                choice("bits", o.positions, {{"32", 32}, {"64", 64}, {"128", 128}, {"256", 256}},
                       "positions of the mask"),
                choice(
                    "pool", o.pool,
                    {{"0", 0},
                     {"4", 4},
                     {"16", 16},
                     {"24", 24},
                     {"30", 30},
                     {"40", 40},
                     {"50", 50},
                     {"60", 60},
                     {"64", 64},
                     {"80", 80},
                     {"96", 96},
                     {"128", 128}},
                    "bytes on chip for each pixel of the bin, which records share; beyond that, records lie in memory"),
                choice("at", o.shade_at,
                       {{"covered", OwnerPlace::covered},
                        {"visible", OwnerPlace::visible},
                        {"quarters", OwnerPlace::quarters},
                        {"sixteenths", OwnerPlace::sixteenths}},
                       "shading point of a surface with a material: the centroid of what its triangle covers, of its "
                       "own positions, or of its positions in each quarter or sixteenth of the pixel"),
                choice("bin", o.bin, {{"8", 8}, {"16", 16}, {"32", 32}}, "pixels on each side of a bin")};
          },
          [](const PooledOptions& o) {
            return Technique{.framebuffer = pooled_framebuffer(o),
                             .positions = o.positions,
                             .counted_positions = o.positions,
                             .renderer = bind_options(render_pooled, o),
                             .is_observable = true,
                             .has_weights = true};
          })};
}

}  // namespace beampipe
