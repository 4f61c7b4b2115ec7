#include "pipeline/techniques/msaa.h"

#include <string>

#include "pipeline/bins/render_bins.h"
#include "pipeline/technique_table.h"
#include "pipeline/units/depth_test_unit.h"
#include "pipeline/units/fragment_units.h"
#include "pipeline/units/raster_units.h"

namespace beampipe {
namespace {

std::uint32_t color_bytes(const MsaaOptions& options) { return options.rgba ? 8 : kSampleColorBytes; }

Framebuffer msaa_framebuffer(const MsaaOptions& options) {
  const auto n = static_cast<std::uint32_t>(options.samples);
  return {.surfaces = {{"depth", times("D32F", n), n * kSampleDepthBytes},
                       {"color", times(options.rgba ? "RGBA16F" : "RGB16F", n), n * color_bytes(options)}},
          .bin_size = bin_size(options.samples)};
}

FrameResult render_msaa(const Trace& trace, const Frame& frame, const MsaaOptions& options, const RunOptions& run) {
  const FrameContext context(trace, frame, run, {.derivatives = Derivatives::quad, .rounds_to_half = true});
  const Sampling sampling = msaa_sampling(options.samples);
  const auto first_pass =
      options.prepass ? DepthTestUnit::FirstPass::writes_depth_alone : DepthTestUnit::FirstPass::writes_color;
  const auto same_color = [&](std::uint32_t a, std::uint32_t b) { return context.shader.same_color(a, b); };
  const BinPlan plan{.stages = {"sample_raster", "shade", "depth_test", "resolve"},
                     .framebuffer = msaa_framebuffer(options)};
  return render_bins(context, plan, [&](Bin& bin) {
    SampleRasterUnit raster(bin, SampleRasterUnit::Translucent::drawn, options.alpha);
    SampleShadeUnit shade(bin, sampling, options.at);
    shade.counts_centroids();
    DepthTestUnit depth_test(bin, sampling, color_bytes(options), first_pass, same_color);
    depth_test.shade_translucent_at(options.at);

    raster.pass(sampling, options.at, [&](std::vector<SampleFragment>& fragments) {
      if (!options.prepass) shade(fragments);
      depth_test.test(fragments);
    });
    depth_test.end_pass();
    if (options.prepass) {  // shades and writes what is visible; the surface already knows which triangles are
      depth_test.add_color(color_bytes(options));
      raster.pass(sampling, options.at, [&](std::vector<SampleFragment>& fragments) {
        depth_test.test_equal(fragments);
        shade(fragments);
      });
      depth_test.end_pass();
    }
    depth_test.count_bytes();
    depth_test.read_colors(bin.stage("resolve"));
    bin.finish(depth_test.resolve_samples(options.at, bin.stage("resolve")));
  });
}

}  // namespace

TechniqueKind msaa_kind() {
  return {
      .name = "msaa",
      .description =
          "multisampling: depth and colour at N samples, one shader invocation per triangle and pixel; above "
          "16 samples, super-resolution of 8x",
      .source = "Direct3D, Vulkan",
      .make = make_from(
          MsaaOptions{},
          [](MsaaOptions& o) -> SpecOptions {
            return {
                samples(o.samples, kMaxMsaaSamples, "samples per pixel"),
                choice("color", o.rgba, {{"rgb16f", false}, {"rgba16f", true}}, "format of a sample's colour"),
                choice("at", o.at, {{"centre", ShadeAt::centre}, {"centroid", ShadeAt::centroid}},
                       "where a fragment is shaded that does not cover the pixel's centre: there all the same, or at "
                       "the centroid of its samples"),
                choice("alpha", o.alpha, {{"test", AlphaCoverage::test}, {"coverage", AlphaCoverage::to_coverage}},
                       "of cutouts: tested once per fragment, or the part of its samples that it takes"),
                flag("prepass", o.prepass,
                     "depth first, so that only visible fragments are shaded; the picture is the same, but that "
                     "translucent triangles are blended over what is opaque and visible in the end")};
          },
          [](const MsaaOptions& o) {
            return Technique{.framebuffer = msaa_framebuffer(o),
                             .samples = static_cast<std::uint32_t>(o.samples),
                             .render = bind_options(render_msaa, o)};
          })};
}

}  // namespace beampipe
