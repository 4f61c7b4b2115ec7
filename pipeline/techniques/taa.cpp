#include "pipeline/techniques/taa.h"

#include "pipeline/memory/image_memory.h"
#include "pipeline/techniques/visibility.h"
#include "pipeline/tiles.h"
#include "pipeline/timeline.h"
#include "stages/geometry/vertex_setup.h"
#include "stages/picture/shade.h"

namespace beampipe {
namespace {

// Sampling at another position of the pixel is what jittering the projection comes to.
SamplePattern jittered(const TaaOptions& options, std::uint32_t frame) {
  const SamplePattern all = standard_pattern(options.samples);
  const std::size_t i = frame % static_cast<std::uint32_t>(options.samples);
  SamplePattern one;
  one.count = 1;
  one.x[0] = all.x[i], one.y[0] = all.y[i];
  return one;
}

}  // namespace

FrameResult render_taa(const Trace& trace, const Frame& frame, const TaaOptions& options, const RunOptions& run) {
  History first;
  History& history = run.history ? *run.history : first;
  StageCounters setup;
  const SetupTriangles triangles = vertex_setup(trace, frame, StageTimer(run.timeline)(setup));
  const std::vector<glm::vec3> colors = shade_triangles(triangles, frame.light_direction);
  const Sampling sampling{CellGrid{}, jittered(options, history.frames)};
  const Poses poses = poses_of(frame);
  const std::vector<glm::dmat4> to_last = to_last_frame(poses, history.frames > 0 ? history.poses : poses);
  CurrentFrame current(frame.width, frame.height);

  FrameResult result =
      render_tiles(frame, triangles, setup, kBinSize, run, [&](const Tile& tile, const TriangleList& list) {
        const StageTimer timed(run.timeline, tile);
        StageCounters moving{"motion"};
        SampleTile surface(tile, sampling, kVisibilityBytes);
        SampleMemory memory(run.memory, tile, sampling, kVisibilityBytes);
        TileResult one =
            visibility_tile(triangles, list, tile, sampling, colors, frame.background, run, memory, surface);
        copy_to_frame(one.image, tile, frame, current.color);
        copy_to_frame(motion(surface, tile, frame, triangles.draws, to_last, timed(moving)), tile, frame,
                      current.motion);
        memory.read_depth(moving);
        memory.read_color(moving);
        stream(run.memory, tile.pixels() * kMotionBytes, moving);
        one.stages.push_back(moving);
        return one;
      });

  StageCounters accumulation{"temporal"};
  std::vector<glm::vec4> image(current.color.size());
  for_each_tile(frame, kBinSize, run, accumulation, [&](const Tile& tile, StageCounters& counters) {
    neighborhood_box(tile, counters, current);
    stream(run.memory, tile.pixels() * kImagePixelBytes, counters);
    temporal(current, {options.blend}, history, tile, counters, image);
    move_temporal(run.memory, tile, history.frames > 0, counters);
  });
  copy_to_image(image, result.image);
  history = {history.frames + 1, current.width, current.height, std::move(image), {}, poses};
  result.stages.push_back(accumulation);
  return result;
}

std::vector<Surface> taa_framebuffer() {
  std::vector<Surface> surfaces = visibility_framebuffer();
  surfaces.push_back({"motion", "RG16F", kMotionBytes});
  surfaces.push_back({"history", "RGBA16F x 2", 16});  // the last one, and the one being written
  return surfaces;
}

}  // namespace beampipe
