#include "pipeline/techniques/dvm.h"

#include "pipeline/memory/geometry_memory.h"
#include "pipeline/memory/image_memory.h"
#include "pipeline/memory/sample_memory.h"
#include "pipeline/sample_batches.h"
#include "pipeline/tiles.h"
#include "pipeline/timeline.h"
#include "stages/geometry/vertex_setup.h"
#include "stages/picture/shade.h"
#include "stages/samples/dilate.h"
#include "stages/samples/materials.h"
#include "stages/samples/sample_select.h"
#include "stages/samples/test_depth.h"

namespace beampipe {
namespace {

// Shading samples with their G-buffer and colour are written at the pixel of the quad that stores them.
void add_sample_bytes(const std::vector<SampleQuad>& quads, const Tile& tile, std::vector<float>& bytes) {
  const std::size_t columns = (static_cast<std::size_t>(tile.width()) + 1) / 2;
  for (std::size_t q = 0; q < quads.size(); ++q)
    for (std::size_t p = 0; p < 4; ++p) {
      if (quads[q].mask[p] == 0) continue;
      const std::size_t x = 2 * (q % columns) + p % 2, y = 2 * (q / columns) + p / 2;
      const bool is_shaded = quads[q].triangle[p] != kNoTriangle;
      bytes[y * static_cast<std::size_t>(tile.width()) + x] +=
          static_cast<float>(kShadingSampleBytes + (is_shaded ? kGBufferBytes + kSampleColorBytes : 0));
    }
}

}  // namespace

FrameResult render_dvm(const Trace& trace, const Frame& frame, const DvmOptions& options, const RunOptions& run) {
  History first;
  History& history = run.history ? *run.history : first;
  StageCounters setup;
  const SetupTriangles triangles = vertex_setup(trace, frame, StageTimer(run.timeline)(setup));
  const std::vector<glm::vec3> colors = shade_triangles(triangles, frame.light_direction);
  const std::vector<std::uint32_t> materials = material_ids(triangles, options.material);
  const Sampling sampling{CellGrid{}, standard_pattern(8)};
  const SelectOptions select{history.frames % 8, options.seed + history.frames};
  const Poses poses = poses_of(frame);
  const std::vector<std::uint32_t> looks = looks_of(frame);
  const std::vector<glm::dmat4> to_last = to_last_frame(poses, history.frames > 0 ? history.poses : poses);
  CurrentFrame current(frame.width, frame.height);
  QuadFrame quads(frame.width, frame.height);

  FrameResult result =
      render_tiles(frame, triangles, setup, kBinSize, run, [&](const Tile& tile, const TriangleList& list) {
        const StageTimer timed(run.timeline, tile);
        StageCounters raster{"sample_raster"}, testing{"depth_test"}, selecting{"sample_select"}, shading{"shade"},
            lighting{"light"}, moving{"motion"};
        SampleTile surface(tile, sampling, kVisibilityBytes);
        SampleMemory memory(run.memory, tile, sampling, kVisibilityBytes);
        std::vector<float> counts(tile.pixels()), bytes(tile.pixels());
        std::vector<SampleAccess> accesses;
        BinBuffers held;
        raster_in_batches(triangles, list, tile, sampling, timed, raster, held,
                          [&](std::vector<SampleFragment>& fragments) {
                            depth_test(triangles, fragments, tile, sampling, timed(testing), surface, accesses);
                            memory.test_and_write(accesses, testing);
                            count_fragments(fragments, tile, sampling.grid, counts);
                          });
        memory.flush(testing);
        const std::vector<SampleQuad> selected = sample_select(surface, tile, materials, select, timed(selecting));
        const std::uint64_t shaded = shaded_samples(selected);
        write_gbuffer(shaded, timed(shading));
        light(shaded, timed(lighting));
        memory.read_color(selecting);
        stream(run.memory, shaded * kShadingSampleBytes, selecting);
        stream(run.memory, shaded * (kVisibilityBytes + kGBufferBytes), shading);
        TriangleFetches fetches(run.memory, list);
        for (const SampleQuad& quad : selected)
          for (const std::uint32_t triangle : quad.triangle)
            if (triangle != kNoTriangle) fetches.attributes(triangle, shading);
        fetches.flush(shading);
        stream(run.memory, shaded * (kGBufferBytes + kSampleColorBytes), lighting);
        memory.read_depth(moving);
        memory.read_color(moving);
        stream(run.memory, tile.pixels() * (kMotionBytes + kLookBytes + kSpeedBytes), moving);
        quads.insert(tile, selected);
        copy_to_frame(motion(surface, tile, frame, triangles.draws, to_last, timed(moving)), tile, frame,
                      current.motion);
        const PixelContents found = contents(surface, tile, frame, triangles.draws, to_last, looks, timed(moving));
        copy_to_frame(found.looks, tile, frame, current.looks);
        copy_to_frame(found.speeds, tile, frame, current.speeds);
        memory.add_bytes(bytes);
        add_sample_bytes(selected, tile, bytes);
        return TileResult{{},
                          {{"fragments", std::move(counts)}, {"bytes", std::move(bytes)}},
                          {raster, testing, selecting, shading, lighting, moving},
                          held};
      });

  StageCounters spreading{"dilate"}, accumulation{"temporal"};
  std::vector<glm::vec4> image(current.color.size());
  for_each_tile(frame, kBinSize, run, spreading, [&](const Tile& tile, StageCounters& counters) {
    dilate(quads, colors, triangles.draws, frame.background, tile, counters, current);
    stream(run.memory, tile.pixels() * (kSampleColorBytes + kShadingSampleBytes), counters);
  });
  for_each_tile(frame, kBinSize, run, accumulation, [&](const Tile& tile, StageCounters& counters) {
    temporal(current, {options.blend, kStillPixels}, history, tile, counters, image);
    move_temporal(run.memory, tile, history.frames > 0, counters);
    stream(run.memory, tile.pixels() * (kSpeedBytes + kLookBytes * (history.frames > 0 ? 2 : 1)), counters);
  });
  result.pixel_counters["unknown"] = unknown_part(current);
  copy_to_image(image, result.image);
  history = {history.frames + 1, current.width, current.height, std::move(image), std::move(current.looks), poses};
  result.stages.insert(result.stages.end(), {spreading, accumulation});
  return result;
}

std::vector<Surface> dvm_framebuffer() {
  return {{"depth", "D32F x 8", 8 * kSampleDepthBytes},
          {"visibility", "R32UI x 8", 8 * kVisibilityBytes},
          {"shading_visibility", "R32UI", kVisibilityBytes},
          {"mask", "R32UI", 4},
          {"location", "R8UI", 1},
          {"gbuffer", "RGBA8 + RGB10A2", kGBufferBytes},
          {"color", "RGB16F", kSampleColorBytes},
          {"motion", "RG16F", kMotionBytes},
          {"speed", "R16F", kSpeedBytes},
          {"look", "R32UI x 2", 2 * kLookBytes},
          {"history", "RGBA16F x 2", 16}};
}

}  // namespace beampipe
