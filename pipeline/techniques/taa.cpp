#include "pipeline/techniques/taa.h"

#include "pipeline/bins/render_bins.h"
#include "pipeline/sampling.h"
#include "pipeline/technique_table.h"
#include "pipeline/techniques/deferred.h"
#include "pipeline/techniques/msaa.h"
#include "pipeline/techniques/visibility.h"
#include "pipeline/units/temporal_units.h"
#include "stages/picture/shade.h"

namespace beampipe {
namespace {

constexpr MsaaOptions kForward{.samples = 1, .at = ShadeAt::sample, .prepass = true};

ShadingRules rules_of(TaaShading shading) {
  switch (shading) {
    case TaaShading::visibility:
      return {.storage = MaterialStorage::gbuffer};
    case TaaShading::deferred:
      return {.derivatives = Derivatives::quad, .storage = MaterialStorage::gbuffer};
    case TaaShading::forward:
      return {.derivatives = Derivatives::quad, .stored_as = AccumulatorFormat::fp16};
  }
  return {};
}

Framebuffer taa_framebuffer(TaaShading shading) {
  Framebuffer framebuffer = visibility_framebuffer();
  if (shading == TaaShading::deferred) framebuffer = deferred_framebuffer();
  if (shading == TaaShading::forward)
    framebuffer = {.surfaces = {{"depth", "D32F", kSampleDepthBytes}, {"color", "RGB16F", kSampleColorBytes}}};
  framebuffer.surfaces.push_back({"motion", "RG16F", kMotionBytes, true});
  framebuffer.surfaces.push_back({"history", "RGBA16F x 2", 16, true});  // the last one, and the one being written
  return framebuffer;
}

std::vector<StageId> stages_of(TaaShading shading, const MemoryParameters& memory) {
  std::vector<StageId> forward = forward_stages(taa_framebuffer(shading), kForward, memory);
  switch (shading) {
    case TaaShading::visibility:
      return {StageId::sample_raster, StageId::depth_test, StageId::material_sort, StageId::shade,
              StageId::light,         StageId::resolve,    StageId::blend,         StageId::motion};
    case TaaShading::deferred:
      return {StageId::sample_raster, StageId::depth_test, StageId::shade, StageId::light,
              StageId::resolve,       StageId::blend,      StageId::motion};
    case TaaShading::forward:
      forward.push_back(StageId::motion);
      return forward;
  }
  return {};
}

// Jittering the projection is the same as sampling at another position of the pixel.
SamplePattern jittered(const TaaOptions& options, std::uint32_t frame) {
  return only(standard_pattern(options.samples), frame % static_cast<std::uint32_t>(options.samples));
}

// Draws and shades the bin's pixels, finds how they moved, and returns the picture.
std::vector<glm::vec4> draw_bin(Bin& bin, TaaShading shading, const Sampling& sampling, const Materials& materials,
                                TemporalFrame& over_time) {
  std::vector<glm::vec4> picture;
  if (shading == TaaShading::visibility) {
    DepthTestUnit visibility(bin, sampling, kVisibilityBytes);
    draw_visibility(bin, visibility);
    picture = shade_visibility(bin, materials, visibility);
    over_time.find_motion(bin, visibility);
  } else {
    DepthTestUnit surface =
        shading == TaaShading::forward ? forward_surface(bin, sampling, kForward) : DepthTestUnit(bin, sampling, 0);
    picture = shading == TaaShading::forward ? draw_forward(bin, kForward, surface) : draw_deferred(bin, surface);
    over_time.find_motion(bin, surface, MotionFrom::depth);
  }
  return picture;
}

std::vector<ErrorSource> error_sources(TaaShading shading) {
  if (shading == TaaShading::forward) return {ErrorSource::sampled_depth};
  return {ErrorSource::sampled_depth, ErrorSource::gbuffer_of_8_bits};
}

FrameResult render_taa(const FrameJob& job, const TaaOptions& options) {
  const FrameContext context(job, rules_of(options.shading));
  TemporalFrame over_time(context, {options.blend});
  const Sampling sampling{CellGrid{}, jittered(options, over_time.history().frames)};
  const Materials materials(material_ids(context.triangles, MaterialBy::color));
  const BinPlan plan{.stages = stages_of(options.shading, job.run.memory),
                     .framebuffer = taa_framebuffer(options.shading),
                     .has_prepass = options.shading != TaaShading::visibility,
                     .empty_bins_differ = true};
  FrameResult result = render_bins(context, plan, [&](Bin& bin) {
    bin.finish(draw_bin(bin, options.shading, sampling, materials, over_time));
    copy_to_frame(bin.picture(), bin.tile, job.frame, over_time.current.color);
  });
  run_on_tiles(context, StageId::temporal, result, [&](const Tile& tile, const BinStage& stage) {
    neighborhood_box(tile, stage.timed(), over_time.current);
    stage.streams(tile.pixels() * kPictureBytes);
    over_time.accumulate(tile, stage);
  });
  over_time.finish(result);
  return result;
}

}  // namespace

TechniqueKind taa_kind() {
  return {.name = "taa",
          .description = "temporal antialiasing of one sample per pixel, jittered over N positions",
          .source = "Lottes 2011, Karis 2014, Salvi 2016",
          .examples = {"taa:8", "taa:8,shading=forward", "taa:8,shading=deferred"},
          .stressed = {"taa:8"},
          .make = make_from(
              TaaOptions{},
              [](TaaOptions& o) -> SpecOptions {
                return {samples(o.samples, kMaxTaaSamples, "positions of the jitter"),
                        number("blend", o.blend, 0.001f, 1.0f, "weight of each new frame"),
                        choice("shading", o.shading,
                               {{"visibility", TaaShading::visibility},
                                {"deferred", TaaShading::deferred},
                                {"forward", TaaShading::forward}},
                               "how a frame is shaded: like visibility, deferred or msaa:1,prepass")};
              },
              [](const TaaOptions& o) {
                return Technique{.framebuffer = taa_framebuffer(o.shading),
                                 .sampled_at = {places_of(msaa_sampling(o.samples)).front()},
                                 .errs_by = error_sources(o.shading),
                                 .renderer = bind_options(render_taa, o),
                                 .keeps_history = true,
                                 .working_bytes_per_pixel = kTemporalWorkingBytes};
              })};
}

}  // namespace beampipe
