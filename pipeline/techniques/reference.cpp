// The truth: 4096 samples per pixel in double precision, on the same snapped triangles as every technique. Other sets
// of samples tell how far it errs.
#include "pipeline/bins/render_bins.h"
#include "pipeline/technique_table.h"
#include "stages/raster/ordered_reference.h"
#include "stages/raster/reference_raster.h"

namespace beampipe {
namespace {

constexpr int kTileSize = 4;  // px: 65,536 samples, 1 MiB

// Of a translucent triangle: a layer at each sample, once more where they are sorted by pixel, and half of that for the
// sort.
std::size_t layer_bytes(const ReferencePattern& pattern) {
  return static_cast<std::size_t>(pattern.samples()) * sizeof(ReferenceTile::Layer) * 5 / 2;
}

// The error of the samples against the exact area. In each row of samples, an edge can be off by at most one sample.
// Rows are shifted against each other, so that the errors of neighbouring rows cancel.
constexpr double kReferenceError = 0x1p-8;

Framebuffer reference_framebuffer(const ReferencePattern& pattern) {
  const auto samples = static_cast<std::uint32_t>(pattern.samples());
  const std::string times = " x " + std::to_string(samples);
  return {.surfaces = {{"depth", "D64F" + times, 8 * samples}, {"owner", "R64UI" + times, 8 * samples}},
          .bin_size = kTileSize};
}

FrameResult render_reference(const FrameJob& job, const ReferencePattern& pattern) {
  FrameInput without_memory = job.run;
  without_memory.memory.modelled = false;  // no hardware is modelled for this
  const FrameContext context({job.trace, job.frame, without_memory, job.sinks},
                             {.derivatives = Derivatives::analytic_of_cells}, DrawOrder::of_api);
  const BinPlan plan{.stages = {StageId::reference_raster, StageId::resolve},
                     .framebuffer = reference_framebuffer(pattern),
                     .translucent_pair_bytes = context.rop ? 0 : layer_bytes(pattern)};
  return render_bins(context, plan, [&](Bin& bin) {
    const BinStage resolving = bin.stage(StageId::resolve);
    if (bin.list.empty()) {  // every sample shows the background, so no samples are set up
      resolving.counters.items_out = bin.tile.pixels();
      resolving.counters.bytes_written = bin.tile.pixels() * sizeof(glm::vec4);
      return bin.finish(std::vector(bin.tile.pixels(), glm::vec4(context.background, 0)));
    }
    const TileShader shader = bin.shader();
    ReferenceTile samples(bin.tile, pattern);
    const BinStage drawing = bin.stage(StageId::reference_raster);
    if (context.rop) {
      ordered_reference({context.triangles, bin.list, bin.tile}, *context.rop, shader, drawing.timed(), samples);
    } else {
      reference_raster({context.triangles, bin.list, bin.tile}, drawing.timed(), samples, &shader);
    }
    bin.finish(resolve(samples, bin.tile, shader, context.background, resolving.timed()));
  });
}

}  // namespace

TechniqueKind reference_kind() {
  return {.name = "reference",
          .description = "4096 samples per pixel in double precision: the truth that errors are measured against",
          .source = "ours",
          .examples = {"reference", "reference:set=2"},
          .stressed = {"reference"},
          .make = make_from(
              ReferencePattern{},
              [](ReferencePattern& pattern) -> SpecOptions {
                return {choice("samples", pattern.columns, {{"4096", 16}, {"16384", 32}}, "samples per pixel"),
                        choice("set", pattern.set, {{"1", 1}, {"2", 2}},
                               "places of the samples; the sets are independent of each other")};
              },
              [](const ReferencePattern& pattern) {
                return Technique{.framebuffer = reference_framebuffer(pattern),
                                 .rounding_error = kReferenceError,
                                 .renderer = bind_options(render_reference, pattern),
                                 .keeps_api_order = true};
              })};
}

}  // namespace beampipe
