// The truth: 4096 samples per pixel in double precision, on the same snapped triangles as every technique.
#include "pipeline/bins/render_bins.h"
#include "pipeline/technique_table.h"
#include "stages/raster/reference_raster.h"

namespace beampipe {
namespace {

constexpr int kTileSize = 4;  // px: 65,536 samples, 1 MiB

// Of a translucent triangle: a layer at each sample, once more where they are sorted by pixel, and half of that for the
// sort.
constexpr std::size_t kLayerBytes = std::size_t{kReferenceSamples} * sizeof(ReferenceTile::Layer) * 5 / 2;

// The error of the samples against the exact area. In each row of samples, an edge can be off by at most one sample.
// Rows are shifted against each other, so that the errors of neighbouring rows cancel.
constexpr double kReferenceError = 0x1p-8;

Framebuffer reference_framebuffer() {
  constexpr std::uint32_t kSamples = kReferenceSamples;
  return {.surfaces = {{"depth", "D64F x 4096", 8 * kSamples}, {"owner", "R64UI x 4096", 8 * kSamples}},
          .bin_size = kTileSize};
}

FrameResult render_reference(const FrameJob& job) {
  FrameInput without_memory = job.run;
  without_memory.memory.modelled = false;  // no hardware is modelled for this
  const FrameContext context({job.trace, job.frame, without_memory, job.sinks});
  const BinPlan plan{.stages = {StageId::reference_raster, StageId::resolve},
                     .framebuffer = reference_framebuffer(),
                     .translucent_pair_bytes = kLayerBytes};
  return render_bins(context, plan, [&](Bin& bin) {
    const BinStage resolving = bin.stage(StageId::resolve);
    if (bin.list.empty()) {  // every sample shows the background, so no samples are set up
      resolving.counters.items_out = bin.tile.pixels();
      resolving.counters.bytes_written = bin.tile.pixels() * sizeof(glm::vec4);
      return bin.finish(std::vector(bin.tile.pixels(), glm::vec4(job.frame.background, 0)));
    }
    const TileShader shader = bin.shader();
    ReferenceTile samples(bin.tile);
    reference_raster(context.triangles, bin.list, bin.tile, bin.stage(StageId::reference_raster).timed(), samples,
                     &shader);
    bin.finish(resolve(samples, bin.tile, shader, job.frame.background, resolving.timed()));
  });
}

}  // namespace

TechniqueKind reference_kind() {
  return {.name = "reference",
          .description = "4096 samples per pixel in double precision: the truth that errors are measured against",
          .source = "ours",
          .examples = {"reference"},
          .stressed = {"reference"},
          .make = make_plain([] {
            return Technique{.framebuffer = reference_framebuffer(),
                             .rounding_error = kReferenceError,
                             .renderer = bind_options(render_reference)};
          })};
}

}  // namespace beampipe
