#include "pipeline/techniques/visibility.h"

#include "pipeline/memory/gbuffer_memory.h"
#include "pipeline/memory/geometry_memory.h"
#include "pipeline/memory/sample_memory.h"
#include "pipeline/sample_batches.h"
#include "pipeline/techniques/deferred.h"
#include "pipeline/tiles.h"
#include "pipeline/timeline.h"
#include "stages/geometry/vertex_setup.h"
#include "stages/picture/resolve.h"
#include "stages/picture/shade.h"
#include "stages/samples/test_depth.h"

namespace beampipe {

FrameResult render_visibility(const Trace& trace, const Frame& frame, const RunOptions& run) {
  StageCounters setup;
  const SetupTriangles triangles = vertex_setup(trace, frame, StageTimer(run.timeline)(setup));
  const std::vector<glm::vec3> colors = shade_triangles(triangles, frame.light_direction);
  const Sampling sampling{CellGrid{}, standard_pattern(1)};
  return render_tiles(frame, triangles, setup, kBinSize, run, [&](const Tile& tile, const TriangleList& list) {
    SampleTile surface(tile, sampling, kVisibilityBytes);
    SampleMemory memory(run.memory, tile, sampling, kVisibilityBytes);
    return visibility_tile(triangles, list, tile, sampling, colors, frame.background, run, memory, surface);
  });
}

TileResult visibility_tile(const SetupTriangles& triangles, const TriangleList& list, const Tile& tile,
                           const Sampling& sampling, const std::vector<glm::vec3>& colors, const glm::vec3& background,
                           const RunOptions& run, SampleMemory& memory, SampleTile& surface) {
  const StageTimer timed(run.timeline, tile);
  StageCounters raster{"sample_raster"}, testing{"depth_test"}, shading{"shade"}, lighting{"light"},
      resolving{"resolve"};
  std::vector<float> counts(tile.pixels()), bytes(tile.pixels());
  std::vector<SampleAccess> accesses;
  BinBuffers held;
  raster_in_batches(triangles, list, tile, sampling, timed, raster, held, [&](std::vector<SampleFragment>& fragments) {
    depth_test(triangles, fragments, tile, sampling, timed(testing), surface, accesses);
    memory.test_and_write(accesses, testing);
    count_fragments(fragments, tile, sampling.grid, counts);
  });
  memory.flush(testing);
  const std::vector<std::uint32_t> shown = shown_pixels(surface, tile);
  write_gbuffer(shown.size(), timed(shading));
  light(shown.size(), timed(lighting));
  const ZOrder order(tile.width(), tile.height());
  memory.add_bytes(bytes);
  TileSurface gbuffer(run.memory, order, 1, kGBufferBytes);
  memory.read_color(shading);
  TriangleFetches fetches(run.memory, list);
  for (const std::uint32_t pixel : shown) fetches.attributes(surface.triangle[pixel], shading);
  fetches.flush(shading);
  write_pixels(shown, gbuffer, shading);
  move_light_and_resolve(run.memory, tile, order, shown, gbuffer, lighting, resolving, bytes);
  surface.color_bytes = kSampleColorBytes;
  return {resolve(surface, tile.pixels(), colors, background, timed(resolving)),
          {{"fragments", std::move(counts)}, {"bytes", std::move(bytes)}},
          {raster, testing, shading, lighting, resolving},
          held};
}

std::vector<Surface> visibility_framebuffer() {
  std::vector<Surface> surfaces = deferred_framebuffer();
  surfaces.insert(surfaces.begin() + 1, {"visibility", "R32UI", kVisibilityBytes});
  return surfaces;
}

}  // namespace beampipe
