#include "pipeline/techniques/deferred.h"

#include "pipeline/memory/gbuffer_memory.h"
#include "pipeline/memory/geometry_memory.h"
#include "pipeline/memory/sample_memory.h"
#include "pipeline/sample_batches.h"
#include "pipeline/tiles.h"
#include "pipeline/timeline.h"
#include "stages/geometry/vertex_setup.h"
#include "stages/picture/resolve.h"
#include "stages/picture/shade.h"
#include "stages/samples/test_depth.h"

namespace beampipe {

FrameResult render_deferred(const Trace& trace, const Frame& frame, const RunOptions& run) {
  StageCounters setup;
  const SetupTriangles triangles = vertex_setup(trace, frame, StageTimer(run.timeline)(setup));
  const std::vector<glm::vec3> colors = shade_triangles(triangles, frame.light_direction);
  const Sampling sampling{CellGrid{}, standard_pattern(1)};
  return render_tiles(frame, triangles, setup, kBinSize, run, [&](const Tile& tile, const TriangleList& list) {
    const StageTimer timed(run.timeline, tile);
    StageCounters raster{"sample_raster"}, testing{"depth_test"}, shading{"shade"}, lighting{"light"},
        resolving{"resolve"};
    SampleTile surface(tile, sampling, 0);
    SampleMemory memory(run.memory, tile, sampling, 0);
    const ZOrder order(tile.width(), tile.height());
    TileSurface gbuffer(run.memory, order, 1, kGBufferBytes);
    AttributesInOrder attributes(run.memory);
    std::vector<float> counts(tile.pixels()), bytes(tile.pixels());
    std::vector<SampleAccess> accesses;
    BinBuffers held;
    raster_in_batches(triangles, list, tile, sampling, timed, raster, held,
                      [&](std::vector<SampleFragment>& fragments) {
                        depth_test(triangles, fragments, tile, sampling, timed(testing), surface, accesses);
                        memory.test_depth(accesses, testing);
                        count_fragments(fragments, tile, sampling.grid, counts);
                      });
    memory.flush(testing);
    raster_in_batches(triangles, list, tile, sampling, timed, raster, held,
                      [&](std::vector<SampleFragment>& fragments) {
                        depth_test_equal(triangles, tile, sampling, timed(testing), surface, fragments, accesses);
                        memory.test_equal(accesses, testing);
                        write_gbuffer(fragments, timed(shading));
                        attributes.read(fragments, shading);
                        for (const SampleAccess& access : accesses)
                          gbuffer.access(access.triangle, access.cell, 0, access.passed, shading);
                      });
    memory.flush(testing);
    gbuffer.flush(shading);
    const std::vector<std::uint32_t> shown = shown_pixels(surface, tile);
    light(shown.size(), timed(lighting));
    move_light_and_resolve(run.memory, tile, order, shown, gbuffer, lighting, resolving, bytes);
    memory.add_bytes(bytes);
    surface.color_bytes = kSampleColorBytes;
    return TileResult{resolve(surface, tile.pixels(), colors, frame.background, timed(resolving)),
                      {{"fragments", std::move(counts)}, {"bytes", std::move(bytes)}},
                      {raster, testing, shading, lighting, resolving},
                      held,
                      2};
  });
}

std::vector<Surface> deferred_framebuffer() {
  return {{"depth", "D32F", kSampleDepthBytes},
          {"gbuffer", "RGBA8 + RGB10A2", kGBufferBytes},
          {"color", "RGB16F", kSampleColorBytes}};
}

}  // namespace beampipe
