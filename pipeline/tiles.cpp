#include "pipeline/tiles.h"

#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>

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

// Copies `values` per pixel of the tile, row by row, to where the tile lies in the frame.
template <class Value>
void copy_rows(const Tile& tile, const Value* from, std::size_t values, std::size_t frame_width, Value* to) {
  const std::size_t row = static_cast<std::size_t>(tile.width()) * values;
  for (std::int32_t y = tile.y0; y < tile.y1; ++y, from += row)
    std::copy_n(from, row,
                to + (static_cast<std::size_t>(y) * frame_width + static_cast<std::size_t>(tile.x0)) * values);
}

void copy_tile(const Tile& tile, const TileResult& from, FrameResult& to) {
  copy_rows(tile, &from.image.front().x, 4, to.image.width, to.image.rgba.data());
  for (const auto& [name, values] : from.pixel_counters)
    copy_rows(tile, values.data(), 1, to.image.width, to.pixel_counters.at(name).data());
}

}  // namespace

FrameResult render_tiles(const Frame& frame, const SetupTriangles& triangles, const StageCounters& vertex_setup,
                         int tile_size, const RunOptions& options, const TileRenderer& renderer) {
  const std::vector<Tile> tiles = make_tiles(frame, tile_size);
  const std::vector<TriangleList> lists = bin_triangles(frame, triangles, tile_size, tiles.size());
  std::vector<TileResult> results(tiles.size());
  const int threads = options.threads > 0 ? options.threads : tbb::info::default_concurrency();
  const tbb::global_control allow(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
  tbb::task_arena arena(threads);
  arena.execute([&] {
    tbb::parallel_for(std::size_t{0}, tiles.size(), [&](std::size_t i) { results[i] = renderer(tiles[i], lists[i]); });
  });

  FrameResult frame_result;
  const std::size_t pixels = std::size_t{frame.width} * frame.height;
  frame_result.image = {frame.width, frame.height, std::vector<float>(4 * pixels)};
  for (const auto& [name, values] : results.front().pixel_counters) frame_result.pixel_counters[name].resize(pixels);
  frame_result.stages = {vertex_setup};
  frame_result.stages.insert(frame_result.stages.end(), results.front().stages.size(), StageCounters{});
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    copy_tile(tiles[i], results[i], frame_result);
    for (std::size_t s = 0; s < results[i].stages.size(); ++s) {
      frame_result.stages[s + 1].stage = results[i].stages[s].stage;
      frame_result.stages[s + 1] += results[i].stages[s];
    }
  }
  StageCounters& raster = frame_result.stages[1];
  raster.items_in += triangles.triangles.size();
  raster.bytes_read += triangles.triangles.size() * sizeof(SetupTriangle);
  return frame_result;
}

void copy_to_frame(const float* tile_values, const Tile& tile, const Frame& frame, std::vector<float>& frame_values) {
  copy_rows(tile, tile_values, 1, frame.width, frame_values.data());
}

std::vector<glm::vec4> pixels_of(const Image& image) {
  std::vector<glm::vec4> pixels(image.rgba.size() / 4);
  for (std::size_t i = 0; i < image.rgba.size(); ++i) pixels[i / 4][static_cast<int>(i % 4)] = image.rgba[i];
  return pixels;
}

Image image_of(const Frame& frame, const std::vector<glm::vec4>& pixels) {
  Image image{frame.width, frame.height, std::vector<float>(4 * pixels.size())};
  for (std::size_t i = 0; i < image.rgba.size(); ++i) image.rgba[i] = pixels[i / 4][static_cast<int>(i % 4)];
  return image;
}

}  // namespace beampipe
