// The beam in streaming order, as immediate-mode hardware works: fragments come in primitive order, without an A-buffer
// or any memory per fragment. The pixels and the pool of their records lie in memory. Of more than twelve owners of a
// pixel, two become one, so no record is longer than 176 bytes.
#include "pipeline/bins/render_bins.h"
#include "pipeline/technique_table.h"
#include "pipeline/units/fragment_units.h"
#include "pipeline/units/pooled_unit.h"
#include "pipeline/units/raster_units.h"

namespace beampipe {
namespace {

constexpr int kPositions = 128;  // of the mask
constexpr std::size_t kWords = kPositions / 32, kOwners = 12;
constexpr int kPoolBytes = 90;  // for each pixel of the frame

Framebuffer stream_framebuffer() { return {.surfaces = pooled_pixel_surfaces(kPoolBytes)}; }

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
    ComposePooledUnit<kWords> compose(bin, owners_bin(bin, positions, bin.list, nullptr, OwnerPlace::covered),
                                      {.bytes_per_pixel = kPoolBytes, .most_owners = kOwners, .is_of_frame = true});

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
              "the surfaces of beam with fragments in primitive order: no A-buffer, no bins, no sort; 128 positions, "
              "and the pool lies in memory; of more than twelve surfaces of a pixel, two are merged",
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
