// The beam in streaming order, as immediate-mode hardware works: fragments come in primitive order, without an A-buffer
// or any memory per fragment. The pixels and the pool of their records lie in memory. Of more than twelve owners of a
// pixel, two become one. Once the pool is full it is closed: from then on a pixel has no more chunks than it has or, if
// these are fewer, than two surfaces take, and further surfaces are merged.
#include <memory>

#include "pipeline/bins/render_bins.h"
#include "pipeline/technique_table.h"
#include "pipeline/units/fragment_units.h"
#include "pipeline/units/pooled_unit.h"
#include "pipeline/units/raster_units.h"
#include "stages/data/mask_words.h"

namespace beampipe {
namespace {

struct StreamOptions {
  // Of the mask. With 256, scenes that leave room in the pool are more accurate, and those that fill it less.
  int positions = 128;
};

constexpr std::size_t kOwners = 12;
constexpr int kPoolBytes = 90;  // for each pixel

Framebuffer stream_framebuffer() { return {.surfaces = pooled_pixel_surfaces(kPoolBytes)}; }

// `closes_at`: the triangle from which on the pool is closed.
template <std::size_t Words>
FrameResult render_frame(const FrameJob& job, FramePool& pool, std::uint32_t closes_at) {
  constexpr int kPositions = 32 * Words;
  const FrameContext context(job, {.takes_positions = true});
  const PositionSet& positions = cell_positions(kPositions);
  const PositionGrid grid(kPositions);
  const BeamFragmentOptions options = grid_options(grid, owners_fragment_bytes(Words), kOwnersWholeFragmentBytes);
  const BinPlan plan{.stages = {StageId::conservative_raster, StageId::beam_fragment, StageId::compose, StageId::shade,
                                StageId::resolve},
                     .framebuffer = stream_framebuffer()};
  return render_bins(context, plan, [&](Bin& bin) {
    ConservativeRasterUnit raster(bin, "", PairDepths::bounds, ConservativeRasterUnit::Hidden::left_out);
    BeamFragmentUnit make_fragments(bin, options);
    ShadeUnit shade(bin);
    bin.triangle_fetches().load_setup();
    ComposePooledUnit<Words> compose(
        bin, owners_bin(bin, positions, bin.list, nullptr),
        {.bytes_per_pixel = kPoolBytes, .most_owners = kOwners, .of_frame = &pool, .closes_at = closes_at});

    raster.queued(bin.list, [&](const std::vector<Pair>& pairs, std::size_t first) {
      compose(make_fragments.queued(pairs), first, raster.closed(), shade);
    });
    bin.finish(compose.resolve_owners(shade));
  });
}

// A frame that fills the pool is rendered again, with the pool closed from there on.
template <std::size_t Words>
FrameResult render_words(const FrameJob& job) {
  const auto new_pool = [&] {
    return std::make_unique<FramePool>(std::size_t{job.frame.width} * job.frame.height, kPoolBytes,
                                       least_chunks(Words));
  };
  FrameInput whole_frame = job.run;
  whole_frame.pixels = nullptr;
  const FrameSinks none;
  const bool collects = !(job.sinks == none) || job.run.pixels;
  const std::unique_ptr<FramePool> claimed = new_pool();
  FrameResult result = render_frame<Words>({job.trace, job.frame, whole_frame, none}, *claimed, ~0u);
  const std::uint32_t full_at = claimed->full_at();
  if (full_at == ~0u && !collects) return result;
  return render_frame<Words>(job, *new_pool(), full_at);
}

FrameResult render_stream(const FrameJob& job, const StreamOptions& stream) {
  return with_words<4, 8>(stream.positions, [&]<std::size_t Words>() { return render_words<Words>(job); });
}

}  // namespace

TechniqueKind beam_stream_kind() {
  return {.name = "beam",
          .variant = {"order", "stream"},
          .description =
              "the surfaces of beam with fragments in primitive order: no A-buffer, no sorted bins; the pool lies in "
              "memory; of more than twelve surfaces of a pixel two are merged, and of fewer once the pool is full",
          .source = "ours",
          .examples = {"beam:order=stream", "beam:order=stream,bits=256"},
          .texture_taps = 16,
          .stressed = {"beam:order=stream", "beam:order=stream,bits=256"},
          .counters = {"memory_chunks", "merges", "record_bytes", "refusals", "lost_specks", "shadings"},
          .make = make_from(
              StreamOptions{},
              [](StreamOptions& o) -> SpecOptions {
                return {choice("bits", o.positions, {{"128", 128}, {"256", 256}},
                               "positions of the mask; records with more of them fill the pool earlier")};
              },
              [](const StreamOptions& o) {
                return Technique{.framebuffer = stream_framebuffer(),
                                 .positions = o.positions,
                                 .counted_positions = o.positions,
                                 .renderer = bind_options(render_stream, o),
                                 .is_observable = true,
                                 .has_weights = true};
              })};
}

}  // namespace beampipe
