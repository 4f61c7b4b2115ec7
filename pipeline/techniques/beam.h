// What the variants of `beam` in near-first order have in common: each bin's triangles are sorted near to far, roughly;
// then one pass over them composes each pixel. They differ in what a pixel keeps.
#pragma once

#include <string>
#include <vector>

#include "pipeline/bins/render_bins.h"
#include "pipeline/technique_table.h"
#include "pipeline/units/fragment_units.h"
#include "pipeline/units/owner_units.h"
#include "pipeline/units/raster_units.h"

namespace beampipe {

// make(bin, positions, ordered, surfaces) returns the unit that composes the bin's fragments. `positions`: of the mask.
template <class Make>
FrameResult render_near_first(const FrameJob& job, int positions, const Framebuffer& framebuffer, Make&& make) {
  const FrameContext context(job, {.takes_positions = true});
  const PositionSet& set = cell_positions(positions);
  const PositionGrid grid(positions);
  const BeamFragmentOptions options =
      grid_options(grid, owners_fragment_bytes(static_cast<std::size_t>(positions) / kMaxMaskSamples));
  const BinPlan plan{.stages = {StageId::bin_sort, StageId::conservative_raster, StageId::beam_fragment,
                                StageId::compose, StageId::shade, StageId::resolve},
                     .framebuffer = framebuffer,
                     .keeps_tile_size = true,
                     .sorts_lists = true,
                     .order = kNearFirstOrder};
  return render_bins(context, plan, [&](Bin& bin) {
    const OrderedList ordered = sort_bin(bin);
    ConservativeRasterUnit raster(bin, "", PairDepths::bounds, ConservativeRasterUnit::Hidden::left_out);
    BeamFragmentUnit make_fragments(bin, options);
    ShadeUnit shade(bin);
    auto compose = make(bin, set, ordered, plan.framebuffer.surfaces);

    raster.queued(ordered.triangles, [&](const std::vector<Pair>& pairs, std::size_t first) {
      compose(make_fragments.queued(pairs), first, raster.closed(), shade);
    });
    bin.finish(compose.resolve_owners(shade));
    shade.finish_fetches();
  });
}

// The options `at` and `bin`.
SpecOption shading_place_option(OwnerPlace& place);
SpecOption bin_size_option(int& pixels);

// `positions`: of the mask.
Technique near_first_technique(const Framebuffer& framebuffer, int positions, decltype(Technique::renderer) renderer);

}  // namespace beampipe
