#include "pipeline/tiles.h"

#include <malloc.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>

#include "pipeline/bands.h"
#include "pipeline/memory/image_memory.h"

namespace beampipe {
namespace {

int thread_count(const RunOptions& options) {
  return options.threads > 0 ? options.threads : tbb::info::default_concurrency();
}

// Calls work(0), work(1), ... work(count - 1), on as many threads as the options allow.
void run_on_threads(std::size_t count, const RunOptions& options, const std::function<void(std::size_t)>& work) {
  const int threads = thread_count(options);
  const tbb::global_control allow(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
  tbb::task_arena arena(threads);
  arena.execute([&] { tbb::parallel_for(std::size_t{0}, count, work); });
}

}  // namespace

FrameResult render_tiles(const Frame& frame, const SetupTriangles& triangles, const StageCounters& vertex_setup,
                         int tile_size, const RunOptions& options, std::size_t pair_bytes,
                         const TileRenderer& renderer) {
  const TileGrid grid(frame, tile_size);
  FrameResult frame_result;
  const std::size_t pixels = std::size_t{frame.width} * frame.height;
  std::vector<glm::vec4> image(pixels);
  frame_result.stages = {vertex_setup};
  stream(options.memory, vertex_setup.bytes_read, frame_result.stages.front());
  for (const Band& band : split_into_bands(triangles, grid, pair_bytes, thread_count(options), options.memory_limit)) {
    if (band.first > 0) malloc_trim(0);  // what glibc keeps of the freed memory of a band adds to that of the next
    const std::vector<TriangleList> lists = bin_triangles(triangles, grid, band);
    std::vector<TileResult> results(lists.size());
    run_on_threads(results.size(), options,
                   [&](std::size_t i) { results[i] = renderer(grid.tiles[band.first + i], lists[i]); });
    for (std::size_t i = 0; i < results.size(); ++i) {
      const Tile& tile = grid.tiles[band.first + i];
      if (!results[i].image.empty()) copy_to_frame(results[i].image, tile, frame, image);
      for (const auto& [name, values] : results[i].pixel_counters) {
        frame_result.pixel_counters[name].resize(pixels);
        copy_to_frame(values, tile, frame, frame_result.pixel_counters[name]);
      }
      frame_result.stages.resize(1 + results[i].stages.size());
      for (std::size_t s = 0; s < results[i].stages.size(); ++s) {
        frame_result.stages[s + 1].stage = results[i].stages[s].stage;
        frame_result.stages[s + 1] += results[i].stages[s];
      }
    }
  }
  frame_result.image = image_of(frame, image);
  StageCounters& raster = frame_result.stages[1];
  raster.items_in += triangles.triangles.size();
  raster.bytes_read += triangles.triangles.size() * sizeof(SetupTriangle);
  return frame_result;
}

void for_each_tile(const Frame& frame, int tile_size, const RunOptions& options, StageCounters& counters,
                   const std::function<void(const Tile&, StageCounters&)>& work) {
  const std::vector<Tile> tiles = TileGrid(frame, tile_size).tiles;
  std::vector<StageCounters> of_tiles(tiles.size());
  run_on_threads(tiles.size(), options, [&](std::size_t i) { work(tiles[i], of_tiles[i]); });
  for (const StageCounters& of_tile : of_tiles) counters += of_tile;
}

Image image_of(const Frame& frame, const std::vector<glm::vec4>& pixels) {
  const float* const first = &pixels.front().x;
  return {frame.width, frame.height, std::vector<float>(first, first + 4 * pixels.size())};
}

}  // namespace beampipe
