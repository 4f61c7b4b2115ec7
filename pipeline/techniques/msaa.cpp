#include "pipeline/techniques/msaa.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "pipeline/bins/render_bins.h"
#include "pipeline/technique_table.h"
#include "pipeline/units/depth_test_unit.h"
#include "pipeline/units/fragment_units.h"
#include "pipeline/units/ordered_unit.h"
#include "pipeline/units/raster_units.h"
#include "pipeline/units/temporal_units.h"

namespace beampipe {
namespace {

// How a sample's colour is stored.
struct ColorFormat {
  const char* name;
  std::uint32_t bytes;
  AccumulatorFormat channel;
};

ColorFormat format_of(const MsaaOptions& options) {
  switch (options.color) {
    case SampleColor::rgba16f:
      return {"RGBA16F", 8, AccumulatorFormat::fp16};
    case SampleColor::rgba8:
      return {"RGBA8", 4, AccumulatorFormat::unorm8};
    case SampleColor::rgba32f:
      return {"RGBA32F", 16, AccumulatorFormat::fp32};
    default:
      return {"RGB16F", kSampleColorBytes, AccumulatorFormat::fp16};
  }
}

std::uint32_t color_bytes(const MsaaOptions& options) { return format_of(options).bytes; }

Framebuffer msaa_framebuffer(const MsaaOptions& options) {
  const auto n = static_cast<std::uint32_t>(options.samples);
  std::vector<Surface> surfaces = {{"depth", times("D32F", n), n * kSampleDepthBytes},
                                   {"color", times(format_of(options).name, n), n * color_bytes(options)}};
  if (options.motion) surfaces.push_back({"motion", "RG16F", kMotionBytes, true});
  return {.surfaces = surfaces, .bin_size = bin_size(options.samples), .needs_bins = options.motion};
}

bool needs_resolve(const Framebuffer& framebuffer, int samples, const MemoryParameters& memory) {
  return samples > 1 || framebuffer.is_on_chip(memory);
}

// How far each pixel moved; 0 if its surface was behind the eye.
void count_motion(const std::vector<glm::vec2>& vectors, std::vector<float>& lengths) {
  for (std::size_t i = 0; i < vectors.size(); ++i) {
    const float length = std::hypot(vectors[i].x, vectors[i].y);
    lengths[i] = std::isfinite(length) ? length : 0.0f;
  }
}

// A depth pre-pass, motion vectors and sorting have no place in it.
bool keeps_api_order(const MsaaOptions& options) {
  return !options.prepass && !options.motion && !options.sorts_translucent;
}

FrameResult render_in_api_order(const FrameContext& context, const MsaaOptions& options, const Sampling& sampling) {
  const Framebuffer framebuffer = msaa_framebuffer(options);
  BinPlan plan{.stages = {StageId::sample_raster, StageId::depth_test, StageId::shade, StageId::blend},
               .framebuffer = framebuffer};
  if (needs_resolve(framebuffer, options.samples, context.run.memory)) plan.stages.push_back(StageId::resolve);
  return render_bins(context, plan, [&](Bin& bin) {
    OrderedUnit surface(bin, sampling, format_of(options).channel, color_bytes(options));
    surface.draw(options.at, options.alpha);
    bin.finish(surface.resolve_samples(options.space));
  });
}

FrameResult render_msaa(const FrameJob& job, const MsaaOptions& options, const Sampling& sampling) {
  const FrameContext context(job, {.derivatives = Derivatives::quad, .stored_as = format_of(options).channel},
                             keeps_api_order(options) ? DrawOrder::of_api : DrawOrder::by_depth);
  if (context.rop) return render_in_api_order(context, options, sampling);
  History first;
  History& history = job.run.history ? *job.run.history : first;
  std::optional<FrameMotion> motion;
  if (options.motion) motion.emplace(context, history);
  const Framebuffer framebuffer = msaa_framebuffer(options);
  BinPlan plan{.stages = forward_stages(framebuffer, options, job.run.memory),
               .framebuffer = framebuffer,
               .has_prepass = options.prepass,
               .empty_bins_differ = options.motion};
  if (options.motion) plan.stages.push_back(StageId::motion);
  if (options.sorts_translucent && context.has_blending()) plan.stages.insert(plan.stages.begin(), StageId::bin_sort);
  FrameResult result = render_bins(context, plan, [&](Bin& bin) {
    DepthTestUnit depth_test = forward_surface(bin, sampling, options);
    bin.finish(draw_forward(bin, options, depth_test));
    if (motion) count_motion(motion->find(bin, depth_test, MotionFrom::depth), bin.pixel_counter("motion"));
  });
  if (motion) {
    ++history.frames;
    history.poses = motion->take_poses();
  }
  return result;
}

Technique technique_of(const MsaaOptions& options, const Sampling& sampling) {
  return {.framebuffer = msaa_framebuffer(options),
          .sampled_at = places_of(sampling),
          .errs_by = {ErrorSource::sampled_depth},
          .rounding_error = options.color == SampleColor::rgba8 ? 0.5 / 255 : kFp16Error,
          .renderer = bind_options(render_msaa, options, sampling),
          .is_observable = true,
          .keeps_api_order = keeps_api_order(options),
          .keeps_history = options.motion};
}

}  // namespace

std::vector<StageId> forward_stages(const Framebuffer& framebuffer, const MsaaOptions& options,
                                    const MemoryParameters& memory) {
  using enum StageId;
  std::vector<StageId> stages = options.prepass ? std::vector{sample_raster, depth_test, blend, shade}
                                                : std::vector{sample_raster, shade, depth_test, blend};
  if (needs_resolve(framebuffer, options.samples, memory)) stages.push_back(StageId::resolve);
  return stages;
}

DepthTestUnit forward_surface(Bin& bin, const Sampling& sampling, const MsaaOptions& options) {
  const auto first_pass =
      options.prepass ? DepthTestUnit::FirstPass::writes_depth_alone : DepthTestUnit::FirstPass::writes_color;
  return {bin, sampling, color_bytes(options), first_pass,
          [&shader = bin.context.shader](std::uint32_t a, std::uint32_t b) { return shader.same_color(a, b); }};
}

std::vector<glm::vec4> draw_forward(Bin& bin, const MsaaOptions& options, DepthTestUnit& depth_test) {
  constexpr auto kAll = SampleRasterUnit::Translucent::drawn;
  const Sampling& sampling = depth_test.sampling();
  SampleRasterUnit raster(bin, kAll, options.alpha);
  if (options.sorts_translucent) raster.sorts_translucent();
  SampleShadeUnit shade(bin, sampling, options.at, color_bytes(options));
  shade.counts_centroids();
  depth_test.shade_translucent_at(options.at);

  if (options.prepass) {  // shades and writes what is visible; the surface already knows which triangles are
    SampleRasterUnit(bin, kAll, options.alpha, Pass::prepass)
        .pass(depth_test, options.at, [&](std::vector<SampleFragment>& fragments) { depth_test.test(fragments); });
    depth_test.add_color(color_bytes(options));
  }
  raster.pass(depth_test, options.at, [&](std::vector<SampleFragment>& fragments) {
    if (options.prepass) depth_test.test_equal(fragments);
    shade(fragments);
    if (!options.prepass) depth_test.test(fragments);
  });
  if (!bin.resolves()) {
    StageCounters nothing_is_moved;
    return depth_test.resolve_samples(options.at, nothing_is_moved, options.space);
  }
  const BinStage resolving = bin.stage(StageId::resolve);
  depth_test.read_colors(resolving);
  return depth_test.resolve_samples(options.at, resolving.timed(), options.space);
}

Technique msaa_at(const std::vector<glm::ivec2>& places) {
  if (places.empty() || places.size() > kMaxMaskSamples)
    throw SpecError("a sample pattern: expected 1 to " + std::to_string(kMaxMaskSamples) + " samples, found " +
                    std::to_string(places.size()));
  SamplePattern pattern;
  for (const glm::ivec2& place : places) {
    const auto i = static_cast<std::size_t>(pattern.count++);
    if (std::min(place.x, place.y) < 0 || std::max(place.x, place.y) >= kSubpixelUnits)
      throw SpecError("a sample pattern: expected samples inside the pixel, found sample " + std::to_string(i) +
                      " outside");
    pattern.x[i] = place.x, pattern.y[i] = place.y;
  }
  return technique_of({.samples = pattern.count}, {CellGrid{}, pattern});
}

TechniqueKind msaa_kind() {
  return {
      .name = "msaa",
      .description =
          "multisampling: depth and colour at N samples, one shader invocation per triangle and pixel; above "
          "16 samples, super-resolution of 8x",
      .source = "Direct3D, Vulkan",
      .examples = {"msaa:1", "msaa:8", "msaa:64", "msaa:8,prepass", "msaa:4,motion,resolve=reinhard",
                   "msaa:4,at=centroid,alpha=coverage", "msaa:4,alpha=sample", "msaa:8,alpha=hashed,blend=sorted"},
      .stressed = {"msaa:1", "msaa:8", "msaa:8,prepass", "msaa:16", "msaa:256"},
      .counters = {"centroids", "motion"},
      .make = make_from(
          MsaaOptions{},
          [](MsaaOptions& o) -> SpecOptions {
            return {
                samples(o.samples, kMaxMsaaSamples, "samples per pixel"),
                choice("color", o.color,
                       {{"rgb16f", SampleColor::rgb16f},
                        {"rgba16f", SampleColor::rgba16f},
                        {"rgba8", SampleColor::rgba8},
                        {"rgba32f", SampleColor::rgba32f}},
                       "format of a sample's colour"),
                choice("at", o.at, {{"centre", ShadeAt::centre}, {"centroid", ShadeAt::centroid}},
                       "shading point when the centre is uncovered: the centre anyway, or the centroid of the covered "
                       "samples"),
                choice("alpha", o.alpha,
                       {{"test", AlphaCoverage::test},
                        {"sample", AlphaCoverage::by_sample},
                        {"hashed", AlphaCoverage::hashed},
                        {"coverage", AlphaCoverage::to_coverage}},
                       "alpha of cutouts: tested once per fragment or at each sample, or taken as the share of its "
                       "samples, which a hash of the place on the surface chooses, or which are the same for all"),
                choice(
                    "blend", o.sorts_translucent, {{"ordered", false}, {"sorted", true}},
                    "translucent triangles: in the order of draws, or after all others, far to near by the mean depth "
                    "of their vertices"),
                flag("prepass", o.prepass,
                     "depth first, so that only visible fragments are shaded; only translucent triangles look "
                     "different: "
                     "they are blended over the opaque surface that is visible in the end"),
                flag("motion", o.motion, "makes motion vectors from the depths, for passes that need them"),
                choice("resolve", o.space, {{"linear", ResolveSpace::linear}, {"reinhard", ResolveSpace::reinhard}},
                       "colours that are averaged: linear, or compressed by Reinhard's operator")};
          },
          [](const MsaaOptions& o) {
            Technique technique = technique_of(o, msaa_sampling(o.samples));
            technique.samples = static_cast<std::uint32_t>(o.samples);
            return technique;
          })};
}

}  // namespace beampipe
