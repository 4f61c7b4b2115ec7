#include "pipeline/techniques/acaa.h"

#include <string>

#include "pipeline/memory/accumulator_memory.h"
#include "pipeline/memory/geometry_memory.h"
#include "pipeline/memory/image_memory.h"
#include "pipeline/memory/sample_memory.h"
#include "pipeline/sample_batches.h"
#include "pipeline/tiles.h"
#include "pipeline/timeline.h"
#include "stages/geometry/vertex_setup.h"
#include "stages/picture/shade.h"
#include "stages/samples/test_depth.h"

namespace beampipe {

FrameResult render_acaa(const Trace& trace, const Frame& frame, const AcaaOptions& options, const RunOptions& run) {
  StageCounters setup;
  const SetupTriangles triangles = vertex_setup(trace, frame, StageTimer(run.timeline)(setup));
  const std::vector<glm::vec3> colors = shade_triangles(triangles, frame.light_direction);
  const std::vector<Sampling> rounds = acaa_rounds(options.samples);

  const TileRenderer render_tile = [&](const Tile& tile, const TriangleList& list) {
    const StageTimer timed(run.timeline, tile);
    StageCounters raster{"sample_raster"}, testing{"depth_test"}, stencil{"stencil_test"}, shading{"shade"},
        accumulation{"accumulate"}, resolving{"resolve"};
    Accumulator accumulator(tile, options.samples, options.color, options.double_counting);
    std::vector<float> counts(tile.pixels()), visible(tile.pixels()), bytes(tile.pixels());
    std::vector<SampleAccess> accesses;
    BinBuffers held;
    const ZOrder order(tile.width(), tile.height());
    AccumulatorMemory color(run.memory, order, 1, accumulator_bytes(options.color));
    accumulator.limit = 0;
    for (const Sampling& sampling : rounds) {
      accumulator.limit += static_cast<float>(sampling.pattern.count) * accumulator.sample_share;
      SampleTile depth(tile, sampling, 0);
      SampleMemory memory(run.memory, tile, sampling, 0);
      StencilMemory taken(run.memory, order, sampling);
      raster_in_batches(triangles, list, tile, sampling, timed, raster, held,
                        [&](std::vector<SampleFragment>& fragments) {
                          depth_test(triangles, fragments, tile, sampling, timed(testing), depth, accesses);
                          memory.test_depth(accesses, testing);
                          count_fragments(fragments, tile, sampling.grid, counts);
                        });
      memory.flush(testing);
      if (options.double_counting == DoubleCounting::saturate) {
        accumulate_background(depth, frame.background, timed(accumulation), accumulator);
        memory.read_depth(accumulation);
        color.blend_background(depth, accumulation);
      }
      accumulator.taken.assign(tile.pixels(), 0);
      AttributesInOrder attributes(run.memory);
      raster_in_batches(triangles, list, tile, sampling, timed, raster, held,
                        [&](std::vector<SampleFragment>& fragments) {
                          depth_test_equal(triangles, tile, sampling, timed(testing), depth, fragments, accesses);
                          memory.test_equal(accesses, testing);
                          if (options.double_counting == DoubleCounting::stencil) {
                            taken.test(fragments, tile, stencil);
                            stencil_test(tile, timed(stencil), accumulator, fragments);
                            taken.mark(fragments, tile, stencil);
                          }
                          shade(fragments, timed(shading), &triangles.attributes);
                          attributes.read(fragments, shading);
                          accumulate(fragments, colors, tile, timed(accumulation), accumulator);
                          color.blend(fragments, tile, accumulation);
                          count_fragments(fragments, tile, sampling.grid, visible);
                        });
      memory.flush(testing);
      memory.add_bytes(bytes);
      taken.add_bytes(bytes);
      taken.flush(stencil);
      color.flush(accumulation);
    }
    color.add_bytes(bytes);
    color.read_all(resolving);
    write_image(run.memory, tile, resolving);
    TileResult result{
        resolve(accumulator, frame.background, timed(resolving)),
        {{"fragments", std::move(counts)}, {"visible_fragments", std::move(visible)}, {"bytes", std::move(bytes)}},
        {raster, testing},
        held,
        2 * static_cast<int>(rounds.size())};
    if (options.double_counting == DoubleCounting::stencil) result.stages.push_back(stencil);
    result.stages.insert(result.stages.end(), {shading, accumulation, resolving});
    return result;
  };
  return render_tiles(frame, triangles, setup, bin_size(rounds.front().pattern.count), run, render_tile);
}

std::vector<Surface> acaa_framebuffer(const AcaaOptions& options) {
  const auto n = static_cast<std::uint32_t>(std::min(options.samples, 16));
  const std::string times = " x " + std::to_string(n);
  const char* const format = options.color == AccumulatorFormat::unorm8 ? "RGBA8"
                             : options.color == AccumulatorFormat::fp16 ? "RGBA16F"
                                                                        : "RGBA32F";
  std::vector<Surface> surfaces = {{"depth", "D32F" + times, n * kSampleDepthBytes},
                                   {"color", format, accumulator_bytes(options.color)}};
  if (options.double_counting == DoubleCounting::stencil) surfaces.push_back({"stencil", "S8UI" + times, n});
  return surfaces;
}

}  // namespace beampipe
