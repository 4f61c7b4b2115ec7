#include "pipeline/techniques/reference.h"

#include "pipeline/tiles.h"
#include "pipeline/timeline.h"
#include "stages/geometry/vertex_setup.h"
#include "stages/picture/shade.h"
#include "stages/raster/reference_raster.h"

namespace beampipe {
namespace {

constexpr int kTileSize = 4;  // px: 65,536 samples, 1 MiB

}  // namespace

FrameResult render_reference(const Trace& trace, const Frame& frame, const RunOptions& run) {
  StageCounters setup;
  const SetupTriangles triangles = vertex_setup(trace, frame, StageTimer(run.timeline)(setup));
  const std::vector<glm::vec3> colors = shade_triangles(triangles, frame.light_direction);
  RunOptions without_memory = run;
  without_memory.memory.modelled = false;  // nobody builds a machine for this
  return render_tiles(
      frame, triangles, setup, kTileSize, without_memory, [&](const Tile& tile, const TriangleList& list) {
        const StageTimer timed(run.timeline, tile);
        StageCounters raster{"reference_raster"}, resolving{"resolve"};
        if (list.empty()) {  // no samples are set up to find that all are the background's
          resolving.items_out = tile.pixels();
          resolving.bytes_written = tile.pixels() * sizeof(glm::vec4);
          return TileResult{std::vector(tile.pixels(), glm::vec4(frame.background, 0)), {}, {raster, resolving}};
        }
        ReferenceTile surface(tile);
        reference_raster(triangles, list, tile, timed(raster), surface);
        return TileResult{resolve(surface, tile, colors, frame.background, timed(resolving)), {}, {raster, resolving}};
      });
}

std::vector<Surface> reference_framebuffer() {
  constexpr std::uint32_t kSamples = kReferenceSamples;
  return {{"depth", "D64F x 4096", 8 * kSamples}, {"owner", "R64UI x 4096", 8 * kSamples}};
}

}  // namespace beampipe
