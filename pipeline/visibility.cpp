#include "pipeline/visibility.h"

#include <set>

#include "pipeline/memory/image_memory.h"
#include "pipeline/memory/sample_memory.h"
#include "pipeline/sample_batches.h"
#include "pipeline/tiles.h"
#include "pipeline/timeline.h"
#include "stages/depth_test.h"
#include "stages/resolve.h"
#include "stages/shade.h"
#include "stages/vertex_setup.h"

namespace beampipe {
namespace {

// The pixels that show a triangle.
std::vector<std::uint32_t> shown_pixels(const SampleTile& surface, const Tile& tile) {
  std::vector<std::uint32_t> pixels;
  for (std::uint32_t pixel = 0; pixel < tile.pixels(); ++pixel)
    if (surface.triangle[pixel] != kNoTriangle) pixels.push_back(pixel);
  return pixels;
}

void write_pixels(const std::vector<std::uint32_t>& pixels, TileSurface& to, StageCounters& counters) {
  for (const std::uint32_t pixel : pixels) to.write(0, pixel, counters);
  to.flush(counters);
}

// By a pixel's triangle number its attributes are fetched from memory: a request each, and each triangle of the bin
// once from DRAM.
void fetch_attributes(const MemoryParameters& memory, const SampleTile& surface,
                      const std::vector<std::uint32_t>& pixels, StageCounters& counters) {
  if (!memory.modelled) return;
  std::set<std::uint32_t> triangles;
  for (const std::uint32_t pixel : pixels) triangles.insert(surface.triangle[pixel]);
  const std::uint64_t sectors = (sizeof(FlatAttributes) + memory.sector_bytes - 1) / memory.sector_bytes;
  counters.sector_bytes += pixels.size() * sectors * memory.sector_bytes;
  counters.dram_bytes += triangles.size() * sectors * memory.sector_bytes;
}

// Light: from the G-buffer to colour. Resolve: from colour to the picture.
void move_light_and_resolve(const MemoryParameters& memory, const Tile& tile, const ZOrder& order,
                            const std::vector<std::uint32_t>& pixels, TileSurface& gbuffer, StageCounters& lighting,
                            StageCounters& resolving) {
  TileSurface color(memory, order, kSampleColorBytes);
  gbuffer.read_all(lighting);
  write_pixels(pixels, color, lighting);
  color.read_all(resolving);
  write_image(memory, tile, resolving);
}

}  // namespace

FrameResult render_deferred(const Trace& trace, const Frame& frame, const RunOptions& run) {
  StageCounters setup;
  const SetupTriangles triangles = vertex_setup(trace, frame, StageTimer(run.timeline)(setup));
  const std::vector<glm::vec3> colors = shade_triangles(triangles, frame.light_direction);
  const Sampling sampling{CellGrid{}, standard_pattern(1)};
  setup += setup;  // the triangles come twice
  return render_tiles(frame, triangles, setup, kBinSize, run, [&](const Tile& tile, const TriangleList& list) {
    const StageTimer timed(run.timeline, tile);
    StageCounters raster{"sample_raster"}, testing{"depth_test"}, shading{"shade"}, lighting{"light"},
        resolving{"resolve"};
    SampleTile surface(tile, sampling, 0);
    SampleMemory memory(run.memory, tile, sampling, 0);
    const ZOrder order(tile.width(), tile.height());
    TileSurface gbuffer(run.memory, order, kGBufferBytes);
    std::vector<SampleAccess> accesses;
    raster_in_batches(triangles, list, tile, sampling, timed, raster, [&](std::vector<SampleFragment>& fragments) {
      depth_test(triangles, fragments, tile, sampling, timed(testing), surface, accesses);
      memory.test_depth(accesses, testing);
    });
    memory.flush(testing);
    raster_in_batches(triangles, list, tile, sampling, timed, raster, [&](std::vector<SampleFragment>& fragments) {
      depth_test_equal(triangles, tile, sampling, timed(testing), surface, fragments, accesses);
      memory.test_equal(accesses, testing);
      write_gbuffer(fragments, timed(shading));
      for (const SampleAccess& access : accesses)
        gbuffer.access(access.triangle, access.cell, 0, access.passed, kGBufferBytes, shading);
    });
    memory.flush(testing);
    gbuffer.flush(shading);
    const std::vector<std::uint32_t> shown = shown_pixels(surface, tile);
    light(shown.size(), timed(lighting));
    move_light_and_resolve(run.memory, tile, order, shown, gbuffer, lighting, resolving);
    surface.color_bytes = kSampleColorBytes;
    return TileResult{resolve(surface, tile.pixels(), colors, frame.background, timed(resolving)),
                      {},
                      {raster, testing, shading, lighting, resolving}};
  });
}

FrameResult render_visibility(const Trace& trace, const Frame& frame, const RunOptions& run) {
  StageCounters setup;
  const SetupTriangles triangles = vertex_setup(trace, frame, StageTimer(run.timeline)(setup));
  const std::vector<glm::vec3> colors = shade_triangles(triangles, frame.light_direction);
  const Sampling sampling{CellGrid{}, standard_pattern(1)};
  return render_tiles(frame, triangles, setup, kBinSize, run, [&](const Tile& tile, const TriangleList& list) {
    SampleTile surface(tile, sampling, kVisibilityBytes);
    return visibility_tile(triangles, list, tile, sampling, colors, frame.background, run, surface);
  });
}

TileResult visibility_tile(const SetupTriangles& triangles, const TriangleList& list, const Tile& tile,
                           const Sampling& sampling, const std::vector<glm::vec3>& colors, const glm::vec3& background,
                           const RunOptions& run, SampleTile& surface) {
  const StageTimer timed(run.timeline, tile);
  StageCounters raster{"sample_raster"}, testing{"depth_test"}, shading{"shade"}, lighting{"light"},
      resolving{"resolve"};
  std::vector<float> counts(tile.pixels()), bytes(tile.pixels());
  SampleMemory memory(run.memory, tile, sampling, kVisibilityBytes);
  std::vector<SampleAccess> accesses;
  raster_in_batches(triangles, list, tile, sampling, timed, raster, [&](std::vector<SampleFragment>& fragments) {
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
  TileSurface gbuffer(run.memory, order, kGBufferBytes);
  memory.read_color(shading);
  fetch_attributes(run.memory, surface, shown, shading);
  write_pixels(shown, gbuffer, shading);
  move_light_and_resolve(run.memory, tile, order, shown, gbuffer, lighting, resolving);
  surface.color_bytes = kSampleColorBytes;
  return {resolve(surface, tile.pixels(), colors, background, timed(resolving)),
          {{"fragments", std::move(counts)}, {"bytes", std::move(bytes)}},
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
