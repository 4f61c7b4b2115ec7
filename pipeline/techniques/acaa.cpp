#include "pipeline/techniques/acaa.h"

#include <string>

#include "pipeline/bins/render_bins.h"
#include "pipeline/sampling.h"
#include "pipeline/technique_table.h"
#include "pipeline/units/accumulate_unit.h"
#include "pipeline/units/depth_test_unit.h"
#include "pipeline/units/fragment_units.h"
#include "pipeline/units/raster_units.h"

namespace beampipe {
namespace {

Framebuffer acaa_framebuffer(const AcaaOptions& options) {
  const auto n = static_cast<std::uint32_t>(std::min(options.samples, 16));
  const char* const format = options.color == AccumulatorFormat::unorm8 ? "RGBA8"
                             : options.color == AccumulatorFormat::fp16 ? "RGBA16F"
                                                                        : "RGBA32F";
  std::vector<Surface> surfaces = {{"depth", times("D32F", n), n * kSampleDepthBytes},
                                   {"color", format, accumulator_bytes(options.color)}};
  if (options.double_counting == DoubleCounting::stencil) surfaces.push_back({"stencil", times("S8UI", n), n});
  return {.surfaces = surfaces, .bin_size = bin_size(static_cast<int>(n))};
}

std::vector<StageId> stages_of(const AcaaOptions& options) {
  if (options.double_counting == DoubleCounting::stencil)
    return {StageId::sample_raster, StageId::depth_test, StageId::stencil_test, StageId::shade,
            StageId::accumulate,    StageId::blend,      StageId::resolve};
  if (options.visible == VisibleSamples::shader)
    return {StageId::sample_raster, StageId::shade, StageId::accumulate, StageId::blend, StageId::resolve};
  return {StageId::sample_raster, StageId::depth_test, StageId::shade,
          StageId::accumulate,    StageId::blend,      StageId::resolve};
}

std::vector<ErrorSource> error_sources(const AcaaOptions& options) {
  std::vector<ErrorSource> sources = {ErrorSource::sampled_depth, ErrorSource::one_translucent_sample};
  if (options.double_counting != DoubleCounting::stencil) sources.push_back(ErrorSource::double_counting);
  if (options.color == AccumulatorFormat::fp16) sources.push_back(ErrorSource::sums_in_fp16);
  if (options.color == AccumulatorFormat::unorm8) sources.push_back(ErrorSource::sums_in_unorm8);
  return sources;
}

// At most one share per sample, and the background; 8 bits round each sum.
double rounding_error(const AcaaOptions& options) {
  return options.color == AccumulatorFormat::unorm8 ? (options.samples + 1) * (0.5 / 255) : kFp16Error;
}

FrameResult render_acaa(const FrameJob& job, const AcaaOptions& options) {
  const FrameContext context(job, {.derivatives = Derivatives::quad});
  const std::vector<Sampling> rounds = acaa_rounds(options.samples);
  const SamplePattern& last = rounds.back().pattern;
  const Sampling central{CellGrid{}, only(last, nearest_to_centre(last))};
  const BinPlan plan{.stages = stages_of(options), .framebuffer = acaa_framebuffer(options), .has_prepass = true};
  return render_bins(context, plan, [&](Bin& bin) {
    const bool tests_in_shader = options.visible == VisibleSamples::shader;
    SampleRasterUnit prepass(bin, Pass::prepass), raster(bin);
    if (tests_in_shader) raster.keeps_hidden();
    SampleShadeUnit shade(bin, rounds.front(), ShadeAt::centroid);
    AccumulateUnit accumulate(bin, options.samples, options.color, options.double_counting);
    std::vector<float>& visible = bin.pixel_counter("visible_fragments");

    for (const Sampling& sampling : rounds) {
      DepthTestUnit depth_test(bin, sampling, 0);
      if (tests_in_shader) depth_test.tests_in_shader();
      prepass.pass(depth_test, ShadeAt::centroid, [&](const auto& fragments) { depth_test.test(fragments); });
      if (accumulate.blends_background()) depth_test.read_depths(accumulate.stage);
      accumulate.start_round(sampling, depth_test.surface());
      shade.start_pass(sampling);
      raster.pass(depth_test, ShadeAt::centroid, [&](std::vector<SampleFragment>& fragments) {
        depth_test.test_equal(fragments);
        accumulate.test_stencil(fragments);
        shade(fragments);
        accumulate(fragments, sampling);
        count_by_pixel(fragments, bin.tile, sampling.grid, visible);
      });
      if (&sampling == &rounds.back()) accumulate.blend_translucent(depth_test, central);
      accumulate.finish_round();
    }
    bin.finish(accumulate.resolve_accumulator());
  });
}

}  // namespace

TechniqueKind acaa_kind() {
  using A = AccumulatorFormat;
  return {
      .name = "acaa",
      .description = "accumulative antialiasing: N depth samples and one colour accumulator per pixel",
      .source = "Enderton et al. 2015",
      .examples = {"acaa:8", "acaa:64,double=stencil,color=unorm8", "acaa:4,double=saturate", "acaa:8,coverage=shader"},
      .stressed = {"acaa:8", "acaa:8,double=stencil", "acaa:8,color=unorm8", "acaa:8,color=fp32", "acaa:256"},
      .counters = {"visible_fragments"},
      .make = make_from(
          AcaaOptions{},
          [](AcaaOptions& o) -> SpecOptions {
            return {samples(o.samples, kMaxAcaaSamples, "samples per pixel"),
                    choice("double", o.double_counting,
                           {{"none", DoubleCounting::none},
                            {"stencil", DoubleCounting::stencil},
                            {"saturate", DoubleCounting::saturate}},
                           "what keeps surfaces of equal depth from being counted twice"),
                    choice("color", o.color, {{"unorm8", A::unorm8}, {"fp16", A::fp16}, {"fp32", A::fp32}},
                           "format of the accumulator"),
                    beside(
                        "double=none or double=saturate", [&o] { return o.double_counting != DoubleCounting::stencil; },
                        choice("coverage", o.visible,
                               {{"post-z", VisibleSamples::post_z}, {"shader", VisibleSamples::shader}},
                               "what finds a fragment's visible samples: the depth test, or the shader, on GPUs that "
                               "test no depth where the colour target has fewer samples"))};
          },
          [](const AcaaOptions& o) {
            return Technique{.framebuffer = acaa_framebuffer(o),
                             .sampled_at = places_of(msaa_sampling(o.samples)),
                             .errs_by = error_sources(o),
                             .rounding_error = rounding_error(o),
                             .renderer = bind_options(render_acaa, o),
                             .is_observable = true};
          })};
}

}  // namespace beampipe
