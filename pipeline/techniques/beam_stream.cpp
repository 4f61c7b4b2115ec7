// The beam in streaming order, as immediate-mode hardware works: fragments come in primitive order, without an A-buffer
// or any memory per fragment. A pixel keeps only its state (stages/data/open_pixel.h); of more owners than it has slots
// for, two become one.
#include "pipeline/bins/render_bins.h"
#include "pipeline/technique_table.h"
#include "pipeline/units/fragment_units.h"
#include "pipeline/units/owner_units.h"
#include "pipeline/units/raster_units.h"

namespace beampipe {
namespace {

constexpr int kPositions = 128;  // of the mask
constexpr std::size_t kWords = kPositions / 32, kSlots = 7;

Framebuffer stream_framebuffer() { return {.surfaces = open_pixel_surfaces(kPositions, kSlots)}; }

FrameResult render_stream(const FrameJob& job) {
  const FrameContext context(job, {.takes_positions = true});
  const PositionSet& positions = cell_positions(kPositions);
  const PositionGrid grid(kPositions);
  const BeamFragmentOptions options = grid_options(grid, owners_fragment_bytes(kWords));
  const BinPlan plan{.stages = {StageId::conservative_raster, StageId::beam_fragment, StageId::compose, StageId::shade,
                                StageId::resolve},
                     .framebuffer = stream_framebuffer()};
  return render_bins(context, plan, [&](Bin& bin) {
    ConservativeRasterUnit raster(bin, "", PairDepths::bounds, ConservativeRasterUnit::Hidden::left_out);
    BeamFragmentUnit make_fragments(bin, options);
    ShadeUnit shade(bin);
    bin.triangle_fetches().load_setup();
    ComposeOwnersUnit<kWords, kSlots> compose(bin, positions, bin.list, nullptr, plan.framebuffer.surfaces);

    raster.queued(bin.list, [&](const std::vector<Pair>& pairs, std::size_t first) {
      compose(make_fragments.queued(pairs), first, raster.closed(), shade);
    });
    bin.finish(compose.resolve_owners(shade));
    shade.finish_fetches();
  });
}

}  // namespace

TechniqueKind beam_stream_kind() {
  return {.name = "beam",
          .variant = {"order", "stream"},
          .description =
              "the surfaces of beam with fragments in primitive order: no A-buffer, no bins, no sort; when slots run "
              "out, two surfaces are merged",
          .source = "ours",
          .examples = {"beam:order=stream"},
          .stressed = {"beam:order=stream"},
          .make = make_plain([] {
            return Technique{.framebuffer = stream_framebuffer(),
                             .positions = kPositions,
                             .counted_positions = kPositions,
                             .renderer = bind_options(render_stream),
                             .is_observable = true,
                             .has_weights = true};
          })};
}

}  // namespace beampipe
