#include "pipeline/visibility.h"

#include "pipeline/sample_batches.h"
#include "pipeline/tiles.h"
#include "stages/depth_test.h"
#include "stages/resolve.h"
#include "stages/shade.h"
#include "stages/vertex_setup.h"

namespace beampipe {
namespace {

constexpr int kTileSize = 64;  // px

std::uint64_t covered_pixels(const SampleTile& surface, const Tile& tile) {
  const auto end = surface.triangle.begin() + static_cast<std::ptrdiff_t>(tile.pixels());
  return tile.pixels() - static_cast<std::uint64_t>(std::count(surface.triangle.begin(), end, kNoTriangle));
}

}  // namespace

FrameResult render_deferred(const Trace& trace, const Frame& frame, const RunOptions& run) {
  StageCounters setup;
  const SetupTriangles triangles = vertex_setup(trace, frame, setup);
  const std::vector<glm::vec3> colors = shade_triangles(triangles, frame.light_direction);
  const Sampling sampling{CellGrid{}, standard_pattern(1)};
  setup += setup;  // the triangles come twice
  return render_tiles(frame, triangles, setup, kTileSize, run, [&](const Tile& tile, const TriangleList& list) {
    StageCounters raster{"sample_raster"}, testing{"depth_test"}, shading{"shade"}, lighting{"light"},
        resolving{"resolve"};
    SampleTile surface(tile, sampling, 0);
    raster_in_batches(triangles, list, tile, sampling, raster, [&](std::vector<SampleFragment>& fragments) {
      depth_test(triangles, fragments, tile, sampling, testing, surface);
    });
    raster_in_batches(triangles, list, tile, sampling, raster, [&](std::vector<SampleFragment>& fragments) {
      depth_test_equal(triangles, tile, sampling, testing, surface, fragments);
      write_gbuffer(fragments, shading);
    });
    light(covered_pixels(surface, tile), lighting);
    surface.color_bytes = kSampleColorBytes;
    return TileResult{resolve(surface, tile.pixels(), colors, frame.background, resolving),
                      {},
                      {raster, testing, shading, lighting, resolving}};
  });
}

FrameResult render_visibility(const Trace& trace, const Frame& frame, const RunOptions& run) {
  StageCounters setup;
  const SetupTriangles triangles = vertex_setup(trace, frame, setup);
  const std::vector<glm::vec3> colors = shade_triangles(triangles, frame.light_direction);
  const Sampling sampling{CellGrid{}, standard_pattern(1)};
  return render_tiles(frame, triangles, setup, kTileSize, run, [&](const Tile& tile, const TriangleList& list) {
    SampleTile surface(tile, sampling, kVisibilityBytes);
    return visibility_tile(triangles, list, tile, sampling, colors, frame.background, surface);
  });
}

TileResult visibility_tile(const SetupTriangles& triangles, const TriangleList& list, const Tile& tile,
                           const Sampling& sampling, const std::vector<glm::vec3>& colors, const glm::vec3& background,
                           SampleTile& surface) {
  StageCounters raster{"sample_raster"}, testing{"depth_test"}, shading{"shade"}, lighting{"light"},
      resolving{"resolve"};
  std::vector<float> counts(tile.pixels());
  raster_in_batches(triangles, list, tile, sampling, raster, [&](std::vector<SampleFragment>& fragments) {
    depth_test(triangles, fragments, tile, sampling, testing, surface);
    count_fragments(fragments, tile, sampling.grid, counts);
  });
  write_gbuffer(covered_pixels(surface, tile), shading);
  light(covered_pixels(surface, tile), lighting);
  surface.color_bytes = kSampleColorBytes;
  return {resolve(surface, tile.pixels(), colors, background, resolving),
          {{"fragments", std::move(counts)}},
          {raster, testing, shading, lighting, resolving}};
}

std::vector<Surface> deferred_framebuffer() {
  return {{"depth", "D32F", kSampleDepthBytes},
          {"gbuffer", "RGBA8 + RGB10A2", kGBufferBytes},
          {"color", "RGB16F", kSampleColorBytes}};
}

std::vector<Surface> visibility_framebuffer() {
  std::vector<Surface> surfaces = deferred_framebuffer();
  surfaces.insert(surfaces.begin() + 1, {"visibility", "R32UI", kVisibilityBytes});
  return surfaces;
}

}  // namespace beampipe
