#include "pipeline/techniques/taa.h"

#include "pipeline/bins/render_bins.h"
#include "pipeline/technique_table.h"
#include "pipeline/techniques/visibility.h"
#include "pipeline/units/temporal_units.h"
#include "stages/picture/shade.h"

namespace beampipe {
namespace {

Framebuffer taa_framebuffer() {
  Framebuffer framebuffer = visibility_framebuffer();
  framebuffer.surfaces.push_back({"motion", "RG16F", kMotionBytes, true});
  framebuffer.surfaces.push_back({"history", "RGBA16F x 2", 16, true});  // the last one, and the one being written
  return framebuffer;
}

// Jittering the projection is the same as sampling at another position of the pixel.
SamplePattern jittered(const TaaOptions& options, std::uint32_t frame) {
  const SamplePattern all = standard_pattern(options.samples);
  const std::size_t i = frame % static_cast<std::uint32_t>(options.samples);
  SamplePattern one;
  one.count = 1;
  one.x[0] = all.x[i], one.y[0] = all.y[i];
  return one;
}

FrameResult render_taa(const Trace& trace, const Frame& frame, const TaaOptions& options, const RunOptions& run) {
  const FrameContext context(trace, frame, run, {.storage = MaterialStorage::gbuffer});
  TemporalFrame over_time(context);
  const Sampling sampling{CellGrid{}, jittered(options, over_time.history().frames)};
  const BinPlan plan{.stages = {"sample_raster", "depth_test", "shade", "light", "resolve", "motion"},
                     .framebuffer = taa_framebuffer(),
                     .writes_frame = true};
  FrameResult result = render_bins(context, plan, [&](Bin& bin) {
    DepthTestUnit visibility(bin, sampling, kVisibilityBytes);
    draw_visibility(bin, sampling, visibility);
    bin.finish(shade_visibility(bin, visibility));
    copy_to_frame(bin.picture(), bin.tile, frame, over_time.current.color);
    over_time.find_motion(bin, visibility);
  });
  run_on_tiles(context, "temporal", result, [&](const Tile& tile, const BinStage& stage) {
    neighborhood_box(tile, stage.timed(), over_time.current);
    stage.streams(tile.pixels() * kPictureBytes);
    over_time.accumulate(tile, {options.blend}, stage);
  });
  over_time.finish(result);
  return result;
}

}  // namespace

TechniqueKind taa_kind() {
  return {.name = "taa",
          .description = "temporal antialiasing of visibility at one sample per pixel, jittered over N positions",
          .source = "Lottes 2011, Karis 2014, Salvi 2016",
          .make = make_from(
              TaaOptions{},
              [](TaaOptions& o) -> SpecOptions {
                return {samples(o.samples, kMaxTaaSamples, "positions of the jitter"),
                        number("blend", o.blend, 0.001f, 1.0f, "weight of each new frame")};
              },
              [](const TaaOptions& o) {
                return Technique{.framebuffer = taa_framebuffer(),
                                 .render = bind_options(render_taa, o),
                                 .keeps_history = true,
                                 .working_bytes_per_pixel = kTemporalWorkingBytes};
              })};
}

}  // namespace beampipe
