// The program `beampipe` with one technique more, which is made of beampipe's stages: how many triangles touch each
// pixel, as a grey level. All commands know it: own_technique compare TRACE -t overdraw -o DIR
#include <algorithm>
#include <utility>
#include <vector>

#include "pipeline/bins/render_bins.h"
#include "pipeline/technique_table.h"
#include "stages/raster/conservative_raster.h"
#include "tools/cli/program.h"

namespace {

using namespace beampipe;

// One bin: its triangles become pairs, and every pair makes its pixel brighter.
void render_bin(Bin& bin) {
  std::vector<Pair> pairs;
  conservative_raster(bin.triangles(), bin.list, bin.tile, bin.stage(StageId::conservative_raster).timed(), pairs);
  std::vector<float>& touched = bin.pixel_counter("touched");
  for (const Pair& pair : pairs) ++touched[bin.tile.index(pair.x, pair.y)];
  std::vector<glm::vec4> picture;
  for (const float count : touched) picture.emplace_back(glm::vec3(std::min(count / 16, 1.0f)), 1.0f);
  bin.finish(std::move(picture));
}

Technique overdraw() {
  Technique technique;
  technique.framebuffer = {.surfaces = {{"count", "R16UI", 2}}};
  technique.renderer = [framebuffer = technique.framebuffer](const Trace& trace, std::size_t frame,
                                                             const FrameInput& run, const FrameSinks& sinks) {
    const FrameContext context({trace, trace.frames[frame], run, sinks});
    const BinPlan plan{.stages = {StageId::conservative_raster, StageId::resolve}, .framebuffer = framebuffer};
    return render_bins(context, plan, render_bin);
  };
  return technique;
}

}  // namespace

// The linker takes this one in place of the library's.
const std::vector<TechniqueKind>& beampipe::technique_kinds() {
  static const std::vector<TechniqueKind> kinds = [] {
    std::vector<TechniqueKind> all = built_in_kinds();
    all.push_back({.name = "overdraw",
                   .description = "triangles that touch a pixel, as a grey level",
                   .source = "an example",
                   .examples = {"overdraw"},
                   .make = make_plain(overdraw)});
    return all;
  }();
  return kinds;
}

int main(int argc, char** argv) { return run_program(argc, argv); }
