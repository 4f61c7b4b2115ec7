#include "pipeline/tiles.h"

#include <malloc.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <mutex>

#include "pipeline/bands.h"
#include "pipeline/memory/geometry_memory.h"
#include "pipeline/threads.h"
#include "pipeline/timeline.h"

namespace beampipe {
namespace {

// What was rendered of a tile, to its place in the frame.
void place(const TileResult& tile_result, const Tile& tile, const Frame& frame, FrameResult& result) {
  const auto* image = reinterpret_cast<const float*>(tile_result.image.data());
  for (std::int32_t y = tile.y0; y < tile.y1 && !tile_result.image.empty(); ++y, image += 4 * tile.width())
    std::copy_n(
        image, 4 * tile.width(),
        result.image.rgba.data() + 4 * (static_cast<std::size_t>(y) * frame.width + static_cast<std::size_t>(tile.x0)));
  for (const auto& [name, values] : tile_result.pixel_counters) {
    const auto of_frame = result.pixel_counters.find(name);
    if (of_frame != result.pixel_counters.end()) copy_to_frame(values, tile, frame, of_frame->second);
  }
}

}  // namespace

FrameResult render_tiles(const Frame& frame, const SetupTriangles& triangles, const StageCounters& vertex_setup,
                         int tile_size, const RunOptions& options, std::size_t pair_bytes,
                         const TileRenderer& renderer) {
  const TileGrid grid(frame, options.tile_size > 0 ? options.tile_size : tile_size);
  const std::size_t pixels = std::size_t{frame.width} * frame.height;
  FrameResult result;
  result.image = {frame.width, frame.height, std::vector<float>(4 * pixels)};
  StageCounters setup_pass = vertex_setup, raster_pass;  // what one pass over the geometry takes
  move_setup(options.memory, vertex_setup.bytes_read, triangles.triangles.size(), setup_pass);
  raster_pass.items_in = vertex_setup.items_out;
  raster_pass.bytes_read = vertex_setup.items_out * sizeof(SetupTriangle);
  result.stages = {StageCounters{vertex_setup.stage}};
  int passes = 1;
  std::uint64_t list_bytes = 0;
  BinBuffers of_bins;
  std::mutex adding;
  const auto render_band = [&](const Band& band) {
    const std::vector<TriangleList> lists = bin_triangles(triangles, grid, band);
    for (const TriangleList& list : lists) {
      list_bytes += list.size() * sizeof list[0];
      raster_pass.empty_tiles += list.empty();
      write_list(options.memory, list, raster_pass);
      read_bin(options.memory, list, raster_pass);
    }
    // Nothing of a tile is kept but these sums, so that large frames take no more than their pictures.
    const auto add = [&](const TileResult& of_tile) {
      const std::lock_guard lock(adding);
      passes = std::max(passes, of_tile.passes);
      for (const auto& [name, bytes] : of_tile.buffers.peaks()) of_bins.holds(name, bytes);
      for (std::size_t s = 0; s < of_tile.stages.size(); ++s) result.stages[s + 1] += of_tile.stages[s];
    };
    const TileResult first = renderer(grid.tiles[band.first], lists.front());  // tells which counters there are
    for (const auto& [name, values] : first.pixel_counters)
      if (name != "bytes" || options.memory.modelled) result.pixel_counters[name].resize(pixels);
    result.stages.resize(1 + first.stages.size());
    for (std::size_t s = 0; s < first.stages.size(); ++s) result.stages[s + 1].stage = first.stages[s].stage;
    add(first);
    place(first, grid.tiles[band.first], frame, result);
    tbb::parallel_for(std::size_t{1}, lists.size(), [&](std::size_t i) {
      const TileResult of_tile = renderer(grid.tiles[band.first + i], lists[i]);
      add(of_tile);
      place(of_tile, grid.tiles[band.first + i], frame, result);
    });
  };
  for (const Band& band :
       split_into_bands(triangles, grid, pair_bytes, thread_count(options.threads), options.memory_limit)) {
    if (band.first > 0) malloc_trim(0);  // what glibc keeps of the freed memory of a band adds to that of the next
    on_threads(options.threads, [&] { render_band(band); });
  }
  for (int pass = 0; pass < passes; ++pass) {
    result.stages[0] += setup_pass;
    result.stages[1] += raster_pass;
  }
  result.buffers = {{"setup_triangles", triangles.triangles.size() * (sizeof(SetupTriangle) + sizeof(FlatAttributes))},
                    {"bin_lists", list_bytes}};
  for (const auto& [name, bytes] : of_bins.peaks()) result.buffers.push_back({name, bytes, true});
  return result;
}

void for_each_tile(const Frame& frame, int tile_size, const RunOptions& options, StageCounters& counters,
                   const std::function<void(const Tile&, StageCounters&)>& work) {
  const std::vector<Tile> tiles = TileGrid(frame, options.tile_size > 0 ? options.tile_size : tile_size).tiles;
  std::vector<StageCounters> of_tiles(tiles.size(), StageCounters{counters.stage});
  on_threads(options.threads, [&] {
    tbb::parallel_for(std::size_t{0}, tiles.size(), [&](std::size_t i) {
      const StageTimer timed(options.timeline, tiles[i]);
      work(tiles[i], timed(of_tiles[i]));
    });
  });
  for (const StageCounters& of_tile : of_tiles) counters += of_tile;
}

void copy_to_image(const std::vector<glm::vec4>& pixels, Image& image) {
  std::copy_n(&pixels.front().x, 4 * pixels.size(), image.rgba.begin());
}

}  // namespace beampipe
