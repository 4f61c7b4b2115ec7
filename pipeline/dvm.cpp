#include "pipeline/dvm.h"

#include <array>
#include <map>

#include "pipeline/sample_batches.h"
#include "pipeline/tiles.h"
#include "stages/depth_test.h"
#include "stages/dilate.h"
#include "stages/resolve.h"
#include "stages/sample_select.h"
#include "stages/shade.h"
#include "stages/vertex_setup.h"

namespace beampipe {
namespace {

// The clamp fades out below this motion, in pixels: the article's remedy for flicker at edges between lit facets.
constexpr double kStillPixels = 0.05;

// A number for each triangle's material.
std::vector<std::uint32_t> material_ids(const SetupTriangles& triangles, MaterialBy by) {
  if (by == MaterialBy::draw) return triangles.draws;
  std::map<std::array<float, 4>, std::uint32_t> numbers;
  std::vector<std::uint32_t> ids;
  ids.reserve(triangles.draws.size());
  for (std::size_t i = 0; i < triangles.draws.size(); ++i) {
    const glm::vec3& kd = triangles.attributes[i].kd;
    const std::array<float, 4> key = {static_cast<float>(triangles.draws[i]), kd.r, kd.g, kd.b};
    ids.push_back(numbers.emplace(key, static_cast<std::uint32_t>(numbers.size())).first->second);
  }
  return ids;
}

}  // namespace

FrameResult render_dvm(const Trace& trace, const Frame& frame, const DvmOptions& options, const RunOptions& run) {
  History first;
  History& history = run.history ? *run.history : first;
  StageCounters setup;
  const SetupTriangles triangles = vertex_setup(trace, frame, setup);
  const std::vector<glm::vec3> colors = shade_triangles(triangles, frame.light_direction);
  const std::vector<std::uint32_t> materials = material_ids(triangles, options.material);
  const Sampling sampling{CellGrid{}, standard_pattern(8)};
  const SelectOptions select{history.frames % 8, options.seed + history.frames};
  CurrentFrame current(frame.width, frame.height);
  current.view_projection = frame.projection * frame.view;
  QuadFrame quads(frame.width, frame.height);

  FrameResult result =
      render_tiles(frame, triangles, setup, sample_tile_size(8), run, [&](const Tile& tile, const TriangleList& list) {
        StageCounters raster{"sample_raster"}, testing{"depth_test"}, selecting{"sample_select"}, shading{"shade"},
            lighting{"light"}, resolving{"resolve_depth"};
        SampleTile surface(tile, sampling, kVisibilityBytes);
        std::vector<SampleFragment> fragments;
        for_each_batch(list, [&](const TriangleList& batch) {
          fragments.clear();
          sample_raster(triangles, batch, tile, sampling, raster, fragments);
          depth_test(triangles, fragments, tile, sampling, testing, surface);
        });
        const std::vector<SampleQuad> selected = sample_select(surface, tile, materials, select, selecting);
        write_gbuffer(shaded_samples(selected), shading);
        light(shaded_samples(selected), lighting);
        quads.insert(tile, selected);
        copy_to_frame(resolve_depth(surface, tile.pixels(), resolving).data(), tile, frame, current.depth);
        return TileResult{
            std::vector<glm::vec4>(tile.pixels()), {}, {raster, testing, selecting, shading, lighting, resolving}};
      });

  StageCounters spreading{"dilate"}, accumulation{"temporal"};
  dilate(quads, colors, triangles.draws, frame.background, spreading, current);
  result.pixel_counters["unknown"] = unknown_part(current);
  result.image = image_of(frame, temporal(current, {options.blend, kStillPixels}, accumulation, history));
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
          {"history", "RGBA16F x 2", 16}};
}

}  // namespace beampipe
