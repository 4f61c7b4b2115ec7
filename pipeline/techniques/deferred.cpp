#include "pipeline/techniques/deferred.h"

#include "pipeline/bins/render_bins.h"
#include "pipeline/sampling.h"
#include "pipeline/technique_table.h"
#include "pipeline/units/depth_test_unit.h"
#include "pipeline/units/gbuffer_unit.h"
#include "pipeline/units/raster_units.h"
#include "pipeline/units/translucent_layer.h"

namespace beampipe {
namespace {

FrameResult render_deferred(const FrameJob& job) {
  const FrameContext context(job, {.derivatives = Derivatives::quad, .storage = MaterialStorage::gbuffer});
  const Sampling sampling{CellGrid{}, standard_pattern(1)};
  const BinPlan plan{.stages = {StageId::sample_raster, StageId::depth_test, StageId::shade, StageId::light,
                                StageId::resolve, StageId::blend},
                     .framebuffer = deferred_framebuffer(),
                     .has_prepass = true};
  return render_bins(context, plan, [&](Bin& bin) {
    DepthTestUnit depth_test(bin, sampling, 0);
    bin.finish(draw_deferred(bin, depth_test));
  });
}

}  // namespace

TechniqueKind deferred_kind() {
  return {.name = "deferred",
          .description = "one sample per pixel: depth, then a G-buffer from 2x2 quads, then lighting per pixel",
          .source = "Burns and Hunt 2013, Hable 2021",
          .examples = {"deferred"},
          .stressed = {"deferred"},
          .make = make_plain([] {
            return Technique{.framebuffer = deferred_framebuffer(),
                             .sampled_at = places_of(msaa_sampling(1)),
                             .errs_by = {ErrorSource::sampled_depth, ErrorSource::gbuffer_of_8_bits},
                             .renderer = bind_options(render_deferred),
                             .is_observable = true};
          })};
}

std::vector<glm::vec4> draw_deferred(Bin& bin, DepthTestUnit& depth_test) {
  GBufferUnit gbuffer(bin, depth_test.sampling());
  SampleRasterUnit(bin, Pass::prepass).pass(depth_test, ShadeAt::sample, [&](const auto& fragments) {
    depth_test.test(fragments);
  });
  SampleRasterUnit(bin).pass(depth_test, ShadeAt::sample, [&](std::vector<SampleFragment>& fragments) {
    depth_test.test_equal(fragments);
    gbuffer.write_fragments(fragments, depth_test);
  });
  std::vector<glm::vec4> picture = gbuffer.light_and_resolve(depth_test);
  put_over(draw_translucent(bin, depth_test, ShadeAt::sample), bin.observers(), picture);
  return picture;
}

Framebuffer deferred_framebuffer() {
  return {.surfaces = {{"depth", "D32F", kSampleDepthBytes},
                       {"gbuffer", "RGBA8 + RGB10A2", kGBufferBytes},
                       {"color", "RGB16F", kSampleColorBytes}},
          .translucent = {translucent_layer(1)}};
}

}  // namespace beampipe
