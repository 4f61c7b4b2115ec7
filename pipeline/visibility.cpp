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

FrameResult render_deferred(const Trace& trace, const Frame& frame, const VisibilityOptions& options,
                            const RunOptions& run) {
  StageCounters setup;
  const SetupTriangles triangles = vertex_setup(trace, frame, setup);
  const std::vector<glm::vec3> colors = shade_triangles(triangles, frame.light_direction);
  const Sampling sampling{CellGrid{}, options.pattern};
  setup += setup;  // the triangles come twice
  return render_tiles(frame, triangles, setup, kTileSize, run, [&](const Tile& tile, const TriangleList& list) {
    StageCounters raster{"sample_raster"}, testing{"depth_test"}, shading{"shade"}, lighting{"light"},
        resolving{"resolve"};
    SampleTile surface(tile, sampling, 0);
    std::vector<SampleFragment> fragments;
    for_each_batch(list, [&](const TriangleList& batch) {
      fragments.clear();
      sample_raster(triangles, batch, tile, sampling, raster, fragments);
      depth_test(triangles, fragments, tile, sampling, testing, surface);
    });
    for_each_batch(list, [&](const TriangleList& batch) {
      fragments.clear();
      sample_raster(triangles, batch, tile, sampling, raster, fragments);
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

FrameResult render_visibility(const Trace& trace, const Frame& frame, const VisibilityOptions& options,
                              const RunOptions& run) {
  StageCounters setup;
  const SetupTriangles triangles = vertex_setup(trace, frame, setup);
  const std::vector<glm::vec3> colors = shade_triangles(triangles, frame.light_direction);
  const Sampling sampling{CellGrid{}, options.pattern};
  return render_tiles(frame, triangles, setup, kTileSize, run, [&](const Tile& tile, const TriangleList& list) {
    StageCounters raster{"sample_raster"}, testing{"depth_test"}, shading{"shade"}, lighting{"light"},
        resolving{"resolve"};
    SampleTile surface(tile, sampling, kVisibilityBytes);
    std::vector<float> counts(tile.pixels());
    std::vector<SampleFragment> fragments;
    for_each_batch(list, [&](const TriangleList& batch) {
      fragments.clear();
      sample_raster(triangles, batch, tile, sampling, raster, fragments);
      depth_test(triangles, fragments, tile, sampling, testing, surface);
      count_fragments(fragments, tile, sampling.grid, counts);
    });
    write_gbuffer(covered_pixels(surface, tile), shading);
    light(covered_pixels(surface, tile), lighting);
    if (options.depth) copy_to_frame(surface.depth.data(), tile, frame, *options.depth);
    surface.color_bytes = kSampleColorBytes;
    return TileResult{resolve(surface, tile.pixels(), colors, frame.background, resolving),
                      {{"fragments", std::move(counts)}},
                      {raster, testing, shading, lighting, resolving}};
  });
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
