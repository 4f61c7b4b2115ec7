#include "pipeline/techniques/msaa.h"

#include <string>

#include "pipeline/memory/geometry_memory.h"
#include "pipeline/memory/image_memory.h"
#include "pipeline/memory/sample_memory.h"
#include "pipeline/sample_batches.h"
#include "pipeline/tiles.h"
#include "pipeline/timeline.h"
#include "stages/geometry/vertex_setup.h"
#include "stages/picture/resolve.h"
#include "stages/picture/shade.h"
#include "stages/raster/sample_raster.h"
#include "stages/samples/test_depth.h"

namespace beampipe {
namespace {

std::uint32_t color_bytes(const MsaaOptions& options) { return options.rgba ? 8 : kSampleColorBytes; }

}  // namespace

FrameResult render_msaa(const Trace& trace, const Frame& frame, const MsaaOptions& options, const RunOptions& run) {
  StageCounters setup;
  const SetupTriangles triangles = vertex_setup(trace, frame, StageTimer(run.timeline)(setup));
  const std::vector<glm::vec3> colors = round_to_half(shade_triangles(triangles, frame.light_direction));
  const Sampling sampling = msaa_sampling(options.samples);

  const TileRenderer render_tile = [&](const Tile& tile, const TriangleList& list) {
    const StageTimer timed(run.timeline, tile);
    StageCounters raster{"sample_raster"}, shading{"shade"}, testing{"depth_test"}, resolving{"resolve"};
    SampleTile surface(tile, sampling, options.prepass ? 0 : color_bytes(options));
    std::vector<float> counts(tile.pixels()), centroids(tile.pixels());
    std::vector<SampleAccess> accesses;
    BinBuffers held;
    const auto same_color = [&](std::uint32_t a, std::uint32_t b) { return colors[a] == colors[b]; };
    SampleMemory memory(run.memory, tile, sampling, color_bytes(options), same_color);
    AttributesInOrder attributes(run.memory);
    const auto shade_all = [&](const std::vector<SampleFragment>& fragments) {
      shade(fragments, timed(shading), &triangles.attributes);
      attributes.read(fragments, shading);
      if (options.at == ShadeAt::centroid)
        count_centroids(triangles, fragments, tile, sampling, timed(shading), centroids);
    };
    raster_in_batches(
        triangles, list, tile, sampling, timed, raster, held, [&](std::vector<SampleFragment>& fragments) {
          if (!options.prepass) shade_all(fragments);
          depth_test(triangles, fragments, tile, sampling, timed(testing), surface, accesses);
          options.prepass ? memory.test_depth(accesses, testing) : memory.test_and_write(accesses, testing);
          count_fragments(fragments, tile, sampling.grid, counts);
        });
    memory.flush(testing);
    surface.color_bytes = color_bytes(options);
    if (options.prepass) {  // shades and writes what is visible; which triangle that is, the surface knows already
      raster_in_batches(triangles, list, tile, sampling, timed, raster, held,
                        [&](std::vector<SampleFragment>& fragments) {
                          depth_test_equal(triangles, tile, sampling, timed(testing), surface, fragments, accesses);
                          memory.test_equal(accesses, testing);
                          shade_all(fragments);
                        });
      memory.flush(testing);
    }
    std::vector<float> bytes(tile.pixels());
    memory.add_bytes(bytes);
    memory.read_color(resolving);
    write_image(run.memory, tile, resolving);
    TileResult result{resolve(surface, tile.pixels(), colors, frame.background, timed(resolving)),
                      {{"fragments", std::move(counts)}, {"bytes", std::move(bytes)}},
                      {raster, shading, testing, resolving},
                      held,
                      options.prepass ? 2 : 1};
    if (options.at == ShadeAt::centroid) result.pixel_counters.emplace_back("centroids", std::move(centroids));
    return result;
  };
  return render_tiles(frame, triangles, setup, bin_size(options.samples), run, render_tile);
}

std::vector<Surface> msaa_framebuffer(const MsaaOptions& options) {
  const auto n = static_cast<std::uint32_t>(options.samples);
  const std::string times = " x " + std::to_string(n);
  return {{"depth", "D32F" + times, n * kSampleDepthBytes},
          {"color", (options.rgba ? "RGBA16F" : "RGB16F") + times, n * color_bytes(options)}};
}

}  // namespace beampipe
