#include "pipeline/beam.h"

#include <string>

#include "pipeline/tiles.h"
#include "stages/a_buffer.h"
#include "stages/aggregate_format.h"
#include "stages/compose.h"
#include "stages/conservative_raster.h"
#include "stages/resolve.h"
#include "stages/shade.h"
#include "stages/vertex_setup.h"

namespace beampipe {
namespace {

constexpr int kTileSize = 32;  // px

std::vector<std::pair<std::string, std::vector<float>>> count_per_pixel(const Tile& tile, const ABuffer& buffer,
                                                                        const std::vector<Fragment>& fragments) {
  std::vector<float> count(tile.pixels()), tiny(tile.pixels());
  for (std::size_t pixel = 0; pixel < tile.pixels(); ++pixel) count[pixel] = static_cast<float>(buffer.depth_of(pixel));
  for (const Fragment& fragment : fragments)
    if (fragment.merge.tiny) ++tiny[fragment.pixel];
  return {{"fragments", count}, {"merges", count}, {"tiny_triangles", std::move(tiny)}};
}

}  // namespace

FrameResult render_beam(const Trace& trace, const Frame& frame, const BeamOptions& beam, const RunOptions& run) {
  StageCounters setup;
  const SetupTriangles triangles = vertex_setup(trace, frame, setup);
  const std::vector<glm::vec3> colors = shade_triangles(triangles, frame.light_direction);
  const SamplePattern pattern = hammersley_pattern();
  const MaskTable table(pattern);

  FrameResult result = render_tiles(
      frame, triangles, setup, kTileSize, run, [&](const Tile& tile, const TriangleList& list) {
        StageCounters raster{"conservative_raster"}, fragment{"beam_fragment"}, shading{"shade"}, buffering{"a_buffer"},
            composition{"compose"}, resolving{"resolve"};
        std::vector<PixelTriangle> pairs;
        std::vector<Fragment> fragments;
        conservative_raster(triangles, list, tile, raster, pairs);
        beam_fragment(triangles, pairs, tile, {beam.mask, pattern, &table}, fragment, fragments);
        shade(colors, fragments, shading);
        const ABuffer buffer = a_buffer(fragments, tile.pixels(), buffering);
        const std::vector<Aggregate> aggregates = beam.composition == Composition::merge
                                                      ? compose(fragments, buffer, pattern, composition)
                                                      : compose_over(fragments, buffer, composition);
        return TileResult{resolve(aggregates, frame.background, resolving), count_per_pixel(tile, buffer, fragments),
                          {raster, fragment, shading, buffering, composition, resolving}};
      });
  const StageCounters& buffering = result.stages[4];
  result.a_buffer_peak_bytes = a_buffer_bytes(buffering.items_in, std::uint64_t{frame.width} * frame.height);
  return result;
}

std::vector<Surface> beam_framebuffer(Composition composition) {
  const Surface color{"color", "RGB16F", kAggregateColorBytes};
  if (composition == Composition::over) return {{"coverage", "R32F", 4}, color};
  return {{"coverage", "R32F", 4}, {"mask", "R32UI", 4},       {"depth_plane", "RGBA32F", 16},
          {"thickness", "R32F", 4}, {"depth_range", "RG32F", 8}, color};
}

}  // namespace beampipe
