// A technique of one's own, made of beampipe's stages: how many triangles touch each pixel, as a grey level.
// own_technique TRACE
#include <algorithm>
#include <exception>
#include <iostream>
#include <vector>

#include "pipeline/bins/render_bins.h"
#include "stages/raster/conservative_raster.h"
#include "traces/files/trace_io.h"

namespace {

using namespace beampipe;

// One bin: its triangles become pairs, and every pair makes its pixel brighter.
void render_bin(Bin& bin) {
  std::vector<Pair> pairs;
  conservative_raster(bin.triangles(), bin.list, bin.tile, bin.stage("conservative_raster").timed(), pairs);
  std::vector<float>& touched = bin.pixel_counter("touched");
  for (const Pair& pair : pairs) ++touched[bin.tile.index(pair.x, pair.y)];
  std::vector<glm::vec4> picture;
  for (const float count : touched) picture.emplace_back(glm::vec3(std::min(count / 16, 1.0f)), 1.0f);
  bin.finish(std::move(picture));
}

Technique overdraw() {
  Technique technique;
  technique.spec = "overdraw";
  technique.framebuffer = {.surfaces = {{"count", "R16UI", 2}}};
  technique.renderer = [framebuffer = technique.framebuffer](const Trace& trace, std::size_t frame,
                                                             const FrameInput& run, const FrameSinks& sinks) {
    const FrameContext context({trace, trace.frames[frame], run, sinks});
    const BinPlan plan{.stages = {"conservative_raster", "resolve"}, .framebuffer = framebuffer};
    return render_bins(context, plan, render_bin);
  };
  return technique;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: own_technique TRACE\n";
    return 2;
  }
  try {
    const Trace trace = read_trace(argv[1]);
    const FrameResult result = overdraw().render(trace, 0, {});
    const std::vector<float>& touched = result.pixel_counters.at("touched");
    double pairs = 0;
    for (const float count : touched) pairs += count;
    std::cout << "triangles that touch a pixel: mean " << pairs / static_cast<double>(touched.size()) << ", most "
              << *std::max_element(touched.begin(), touched.end()) << '\n';
  } catch (const std::exception& error) {
    std::cerr << "own_technique: error: " << error.what() << '\n';
    return 1;
  }
}
