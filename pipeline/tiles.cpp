#include "pipeline/tiles.h"

#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>

#include "pipeline/memory/image_memory.h"
#include "simd/sample_pattern.h"
#include "stages/traverse.h"

namespace beampipe {
namespace {

std::vector<Tile> make_tiles(const Frame& frame, std::int32_t size) {
  std::vector<Tile> tiles;
  const auto width = static_cast<std::int32_t>(frame.width), height = static_cast<std::int32_t>(frame.height);
  for (std::int32_t y = 0; y < height; y += size)
    for (std::int32_t x = 0; x < width; x += size)
      tiles.push_back({x, y, std::min(x + size, width), std::min(y + size, height)});
  return tiles;
}

// One list per tile: the triangles whose closed bounds touch it.
std::vector<TriangleList> bin_triangles(const Frame& frame, const SetupTriangles& triangles, std::int32_t size,
                                        std::size_t tiles) {
  const Tile whole{0, 0, static_cast<std::int32_t>(frame.width), static_cast<std::int32_t>(frame.height)};
  const auto columns = (whole.x1 + size - 1) / size;
  std::vector<TriangleList> lists(tiles);
  for (std::uint32_t i = 0; i < triangles.triangles.size(); ++i) {
    const CellRange range = touched_range(triangles.triangles[i], whole, CellGrid{});
    if (range.x0 >= range.x1 || range.y0 >= range.y1) continue;
    for (std::int32_t y = range.y0 / size; y <= (range.y1 - 1) / size; ++y)
      for (std::int32_t x = range.x0 / size; x <= (range.x1 - 1) / size; ++x)
        lists[static_cast<std::size_t>(y * columns + x)].push_back(i);
  }
  return lists;
}

// Calls work(0), work(1), ... work(count - 1), on as many threads as the options allow.
void run_on_threads(std::size_t count, const RunOptions& options, const std::function<void(std::size_t)>& work) {
  const int threads = options.threads > 0 ? options.threads : tbb::info::default_concurrency();
  const tbb::global_control allow(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
  tbb::task_arena arena(threads);
  arena.execute([&] { tbb::parallel_for(std::size_t{0}, count, work); });
}

}  // namespace

FrameResult render_tiles(const Frame& frame, const SetupTriangles& triangles, const StageCounters& vertex_setup,
                         int tile_size, const RunOptions& options, const TileRenderer& renderer) {
  const std::vector<Tile> tiles = make_tiles(frame, tile_size);
  const std::vector<TriangleList> lists = bin_triangles(frame, triangles, tile_size, tiles.size());
  std::vector<TileResult> results(tiles.size());
  run_on_threads(tiles.size(), options, [&](std::size_t i) { results[i] = renderer(tiles[i], lists[i]); });

  FrameResult frame_result;
  const std::size_t pixels = std::size_t{frame.width} * frame.height;
  std::vector<glm::vec4> image(pixels);
  for (const auto& [name, values] : results.front().pixel_counters) frame_result.pixel_counters[name].resize(pixels);
  frame_result.stages = {vertex_setup};
  stream(options.memory, vertex_setup.bytes_read, frame_result.stages.front());
  frame_result.stages.insert(frame_result.stages.end(), results.front().stages.size(), StageCounters{});
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    if (!results[i].image.empty()) copy_to_frame(results[i].image, tiles[i], frame, image);
    for (const auto& [name, values] : results[i].pixel_counters)
      copy_to_frame(values, tiles[i], frame, frame_result.pixel_counters.at(name));
    for (std::size_t s = 0; s < results[i].stages.size(); ++s) {
      frame_result.stages[s + 1].stage = results[i].stages[s].stage;
      frame_result.stages[s + 1] += results[i].stages[s];
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
  const std::vector<Tile> tiles = make_tiles(frame, tile_size);
  std::vector<StageCounters> of_tiles(tiles.size());
  run_on_threads(tiles.size(), options, [&](std::size_t i) { work(tiles[i], of_tiles[i]); });
  for (const StageCounters& of_tile : of_tiles) counters += of_tile;
}

Image image_of(const Frame& frame, const std::vector<glm::vec4>& pixels) {
  const float* const first = &pixels.front().x;
  return {frame.width, frame.height, std::vector<float>(first, first + 4 * pixels.size())};
}

}  // namespace beampipe
