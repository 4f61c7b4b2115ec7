// The beam in streaming order, as immediate-mode hardware works: fragments come in primitive order, without an A-buffer
// or any memory per fragment. The pixels and the pool of their records lie in memory. Once the pool is full it is
// closed: from then on a pixel has no more chunks than it has or, if these are fewer, than two surfaces take, and
// further surfaces are merged.
#include <memory>

#include "pipeline/bins/render_bins.h"
#include "pipeline/technique_table.h"
#include "pipeline/units/fragment_units.h"
#include "pipeline/units/pooled_unit.h"
#include "pipeline/units/raster_units.h"

namespace beampipe {
namespace {

constexpr int kPositions = 256;  // of the mask
constexpr std::size_t kWords = kPositions / 32;
constexpr int kPoolBytes = 90;  // for each pixel

Framebuffer stream_framebuffer() { return {.surfaces = pooled_pixel_surfaces(kPoolBytes)}; }

// `closes_at`: the triangle from which on the pool is closed.
FrameResult render_frame(const FrameJob& job, FramePool& pool, std::uint32_t closes_at) {
  const FrameContext context(job, {.takes_positions = true});
  const PositionSet& positions = cell_positions(kPositions);
  const PositionGrid grid(kPositions);
  const BeamFragmentOptions options = grid_options(grid, owners_fragment_bytes(kWords), kOwnersWholeFragmentBytes);
  const BinPlan plan{.stages = {StageId::conservative_raster, StageId::beam_fragment, StageId::compose, StageId::shade,
                                StageId::resolve},
                     .framebuffer = stream_framebuffer()};
  return render_bins(context, plan, [&](Bin& bin) {
    ConservativeRasterUnit raster(bin, "", PairDepths::bounds, ConservativeRasterUnit::Hidden::left_out);
    BeamFragmentUnit make_fragments(bin, options);
    ShadeUnit shade(bin);
    bin.triangle_fetches().load_setup();
    ComposePooledUnit<kWords> compose(bin, owners_bin(bin, positions, bin.list, nullptr),
                                      {.bytes_per_pixel = kPoolBytes, .of_frame = &pool, .closes_at = closes_at});

    raster.queued(bin.list, [&](const std::vector<Pair>& pairs, std::size_t first) {
      compose(make_fragments.queued(pairs), first, raster.closed(), shade);
    });
    bin.finish(compose.resolve_owners(shade));
    shade.finish_fetches();
  });
}

// A frame that fills the pool is rendered again, with the pool closed from there on.
FrameResult render_stream(const FrameJob& job) {
  const auto new_pool = [&] {
    return std::make_unique<FramePool>(std::size_t{job.frame.width} * job.frame.height, kPoolBytes,
                                       least_chunks(kWords));
  };
  FrameInput whole_frame = job.run;
  whole_frame.pixels = nullptr;
  const FrameSinks none;
  const bool collects = !(job.sinks == none) || job.run.pixels;
  const std::unique_ptr<FramePool> claimed = new_pool();
  FrameResult result = render_frame({job.trace, job.frame, whole_frame, none}, *claimed, ~0u);
  const std::uint32_t full_at = claimed->full_at();
  if (full_at == ~0u && !collects) return result;
  return render_frame(job, *new_pool(), full_at);
}

}  // namespace

TechniqueKind beam_stream_kind() {
  return {.name = "beam",
          .variant = {"order", "stream"},
          .description =
              "the surfaces of beam with fragments in primitive order: no A-buffer, no sorted bins; the pool lies in "
              "memory, and once it is full, surfaces of a pixel are merged",
          .source = "ours",
          .examples = {"beam:order=stream"},
          .texture_taps = 16,
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
