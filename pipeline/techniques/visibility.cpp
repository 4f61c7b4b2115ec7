#include "pipeline/techniques/visibility.h"

#include "pipeline/bins/render_bins.h"
#include "pipeline/technique_table.h"
#include "pipeline/techniques/deferred.h"
#include "pipeline/units/gbuffer_unit.h"
#include "pipeline/units/raster_units.h"
#include "pipeline/units/translucent_layer.h"

namespace beampipe {
namespace {

FrameResult render_visibility(const Trace& trace, const Frame& frame, const RunOptions& run) {
  const FrameContext context(trace, frame, run, {.storage = MaterialStorage::gbuffer});
  const Sampling sampling{CellGrid{}, standard_pattern(1)};
  const BinPlan plan{.stages = {"sample_raster", "depth_test", "shade", "light", "resolve"},
                     .framebuffer = visibility_framebuffer()};
  return render_bins(context, plan, [&](Bin& bin) {
    DepthTestUnit visibility(bin, sampling, kVisibilityBytes);
    draw_visibility(bin, sampling, visibility);
    bin.finish(shade_visibility(bin, visibility));
  });
}

}  // namespace

TechniqueKind visibility_kind() {
  return {.name = "visibility",
          .description = "one sample per pixel: triangle ids and depth, then shading per pixel",
          .source = "Burns and Hunt 2013, Hable 2021",
          .make = make_plain([] {
            return Technique{.framebuffer = visibility_framebuffer(), .render = bind_options(render_visibility)};
          })};
}

void draw_visibility(Bin& bin, const Sampling& sampling, DepthTestUnit& visibility) {
  SampleRasterUnit(bin).pass(sampling, ShadeAt::sample, [&](const auto& fragments) { visibility.test(fragments); });
  visibility.end_pass();
}

std::vector<glm::vec4> shade_visibility(Bin& bin, DepthTestUnit& visibility) {
  GBufferUnit gbuffer(bin);
  gbuffer.write_visible(visibility);
  std::vector<glm::vec4> picture = gbuffer.light_and_resolve(visibility);
  put_over(draw_translucent(bin, visibility, ShadeAt::sample), picture);
  visibility.count_bytes();
  return picture;
}

Framebuffer visibility_framebuffer() {
  Framebuffer framebuffer = deferred_framebuffer();
  framebuffer.surfaces.insert(framebuffer.surfaces.begin() + 1, {"visibility", "R32UI", kVisibilityBytes});
  return framebuffer;
}

}  // namespace beampipe
