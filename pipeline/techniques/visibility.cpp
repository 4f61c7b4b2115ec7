#include "pipeline/techniques/visibility.h"

#include "pipeline/bins/render_bins.h"
#include "pipeline/sampling.h"
#include "pipeline/technique_table.h"
#include "pipeline/units/gbuffer_unit.h"
#include "pipeline/units/raster_units.h"
#include "pipeline/units/translucent_layer.h"

namespace beampipe {
namespace {

FrameResult render_visibility(const FrameJob& job, const VisibilityOptions& options) {
  const FrameContext context(job, {.storage = MaterialStorage::gbuffer});
  const Sampling sampling{CellGrid{}, standard_pattern(options.samples)};
  const Materials materials(material_ids(context.triangles, MaterialBy::color));
  const BinPlan plan{.stages = {StageId::sample_raster, StageId::depth_test, StageId::material_sort, StageId::shade,
                                StageId::light, StageId::resolve, StageId::blend},
                     .framebuffer = visibility_framebuffer(options.samples)};
  return render_bins(context, plan, [&](Bin& bin) {
    DepthTestUnit visibility(bin, sampling, kVisibilityBytes);
    draw_visibility(bin, visibility);
    bin.finish(shade_visibility(bin, materials, visibility));
  });
}

}  // namespace

TechniqueKind visibility_kind() {
  return {.name = "visibility",
          .description = "triangle ids and depth at N samples per pixel, then shading of every sample",
          .source = "Burns and Hunt 2013, Hable 2021",
          .examples = {"visibility", "visibility:8"},
          .stressed = {"visibility"},
          .make = make_from(
              VisibilityOptions{},
              [](VisibilityOptions& o) -> SpecOptions {
                return {optional_samples(o.samples, kMaxVisibilitySamples, "samples per pixel, all of them shaded")};
              },
              [](const VisibilityOptions& o) {
                return Technique{.framebuffer = visibility_framebuffer(o.samples),
                                 .sampled_at = places_of(msaa_sampling(o.samples)),
                                 .errs_by = {ErrorSource::sampled_depth, ErrorSource::gbuffer_of_8_bits},
                                 .renderer = bind_options(render_visibility, o),
                                 .is_observable = true};
              })};
}

void draw_visibility(Bin& bin, DepthTestUnit& visibility) {
  SampleRasterUnit(bin).pass(visibility, ShadeAt::sample, [&](const auto& fragments) { visibility.test(fragments); });
}

std::vector<glm::vec4> shade_visibility(Bin& bin, const Materials& materials, DepthTestUnit& visibility) {
  GBufferUnit gbuffer(bin, visibility.sampling());
  gbuffer.write_visible(visibility, materials);
  std::vector<glm::vec4> picture = gbuffer.light_and_resolve(visibility);
  const ShadeAt at = visibility.sampling().pattern.count == 1 ? ShadeAt::sample : ShadeAt::centroid;
  put_over(draw_translucent(bin, visibility, at), bin.observers(), picture);
  return picture;
}

Framebuffer visibility_framebuffer(int samples) {
  const auto n = static_cast<std::uint32_t>(samples);
  const auto format = [n](const char* one) { return n == 1 ? one : times(one, n); };
  return {.surfaces = {{"depth", format("D32F"), n * kSampleDepthBytes},
                       {"visibility", format("R32UI"), n * kVisibilityBytes},
                       {"gbuffer", n == 1 ? "RGBA8 + RGB10A2" : times("(RGBA8 + RGB10A2)", n), n * kGBufferBytes},
                       {"color", format("RGB16F"), n * kSampleColorBytes}},
          .translucent = {translucent_layer(n)},
          .bin_size = bin_size(samples)};
}

}  // namespace beampipe
