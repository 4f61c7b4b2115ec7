#include "pipeline/bins/bands.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <stdexcept>
#include <string>

#include "stages/raster/traverse.h"

namespace beampipe {
namespace {

// Division that rounds down for negative values too; `by` > 0.
std::int64_t floor_of(std::int64_t value, std::int64_t by) { return value / by - (value % by < 0); }

// Narrows the columns [left, right] of a row of tiles between `top` and `bottom` (1/256 px) to those that no edge of
// the triangle excludes. As for cells, each edge is tested at the corner of the tile that lies deepest inside
// (stages/raster/traverse.h). Tiles and triangle are closed sets.
void narrow(const EdgeSet& set, std::int64_t top, std::int64_t bottom, std::int64_t tile_size, std::int32_t& left,
            std::int32_t& right) {
  for (const Edge& edge : set.edges) {
    const std::int64_t at_zero = edge.at(0, edge.b > 0 ? bottom : top);
    if (edge.a > 0) {  // the first tile whose right side is inside
      const std::int64_t outside = floor_of(-at_zero - 1, edge.a * tile_size);
      left = static_cast<std::int32_t>(std::clamp<std::int64_t>(outside, left, right + 1));
    } else if (edge.a < 0) {  // the last tile whose left side is inside
      const std::int64_t inside = floor_of(at_zero, -edge.a * tile_size);
      right = static_cast<std::int32_t>(std::clamp<std::int64_t>(inside, left - 1, right));
    } else if (at_zero < 0) {
      right = left - 1;
    }
  }
}

// Calls visit(tile) for each tile of the band that the closed triangle touches.
template <class Visit>
void for_touched_tiles(const SetupTriangle& triangle, const TileGrid& grid, const Band& band, Visit&& visit) {
  const Tile frame{0, 0, grid.tiles.back().x1, grid.tiles.back().y1};
  const CellRange range = touched_range(triangle, frame, CellGrid{});
  if (range.x0 >= range.x1 || range.y0 >= range.y1) return;
  const std::int32_t first_column = grid.tiles_in(range.x0), last_column = grid.tiles_in(range.x1 - 1);
  const std::int32_t last_row = grid.tiles_in(range.y1 - 1);
  const std::int64_t size = std::int64_t{grid.size} * kSubpixelUnits;
  for (std::int32_t y = grid.tiles_in(range.y0); y <= last_row; ++y) {
    const auto row = static_cast<std::size_t>(y * grid.columns);
    if (row + static_cast<std::size_t>(grid.columns) <= band.first || row >= band.last) continue;
    std::int32_t left = first_column, right = last_column;
    if (left < right) narrow(EdgeSet(triangle), y * size, (y + 1) * size, size, left, right);
    for (std::int32_t x = left; x <= right; ++x) {
      const std::size_t tile = row + static_cast<std::size_t>(x);
      if (tile >= band.first && tile < band.last) visit(tile);
    }
  }
}

// Memory that tiles need at the same time, in bytes.
struct Need {
  std::uint64_t lists = 0, pairs = 0, largest = 0;

  void add(std::uint64_t list_bytes, std::uint64_t pair_bytes) {
    lists += list_bytes;
    pairs += pair_bytes;
    largest = std::max(largest, pair_bytes);
  }
  std::uint64_t bytes(int threads) const {
    return lists + std::min(pairs, largest * static_cast<std::uint64_t>(threads));
  }
};

// An upper bound of the pixels that a triangle touches: those of its box, or its area plus the pixels that its border
// touches. A side touches at most 2 pixels per pixel of its height and 2 per pixel of its width, plus 4 at corners, and
// the heights and widths of all sides add up to twice the box's.
std::uint64_t most_pixels(const SetupTriangle& triangle, std::uint64_t width, std::uint64_t height) {
  const std::uint64_t pixels = width * height, on_border = 4 * (width + height) + 16;
  if (pixels <= on_border) return pixels;
  const auto side = [&](int k) {
    return glm::dvec2(triangle.x[k] - triangle.x[0], triangle.y[k] - triangle.y[0]) / double{kSubpixelUnits};
  };
  const glm::dvec2 a = side(1), b = side(2);
  const double area = 0.5 * std::abs(a.x * b.y - a.y * b.x);
  return static_cast<std::uint64_t>(std::min(area + static_cast<double>(on_border), static_cast<double>(pixels)));
}

// An upper bound, found quickly from the triangles' bounds, of what the frame needs as one band.
std::uint64_t most_bytes(const SetupTriangles& triangles, const TileGrid& grid, const PairBytes& pair_bytes) {
  const Tile frame{0, 0, grid.tiles.back().x1, grid.tiles.back().y1};
  std::uint64_t bytes = 0;
  for (std::uint32_t i = 0; i < triangles.triangles.size(); ++i) {
    const SetupTriangle& triangle = triangles.triangles[i];
    const CellRange range = touched_range(triangle, frame, CellGrid{});
    if (range.x0 >= range.x1 || range.y0 >= range.y1) continue;
    const std::int32_t width = range.x1 - range.x0, height = range.y1 - range.y0;
    const auto tiles = static_cast<std::uint64_t>((grid.tiles_in(width) + 2) * (grid.tiles_in(height) + 2));
    bytes += most_pixels(triangle, static_cast<std::uint64_t>(width), static_cast<std::uint64_t>(height)) *
                 pair_bytes.of(i) +
             tiles * sizeof(std::uint32_t);
  }
  return bytes;
}

// Of the pairs of a tile.
std::uint64_t bytes_of_pairs(const SetupTriangles& triangles, const TriangleList& list, const Tile& tile,
                             const PairBytes& pair_bytes) {
  Traversal traversal{tile};
  std::uint64_t bytes = 0;
  for (const std::uint32_t index : list) {
    const std::size_t each = pair_bytes.of(index);
    if (each == 0) continue;
    const SetupTriangle& triangle = triangles.triangles[index];
    traverse_quads(triangle, EdgeSet(triangle), traversal, [&](std::int32_t, std::int32_t, const QuadRow& pixels) {
      bytes += static_cast<std::uint64_t>(std::popcount(pixels.touched)) * each;
    });
  }
  return bytes;
}

std::string mebibytes(std::uint64_t bytes) { return std::to_string((bytes + (1u << 20) - 1) >> 20) + " MiB"; }

}  // namespace

TileGrid::TileGrid(const Frame& frame, std::int32_t tile_size)
    : size(tile_size), inverse_((std::uint64_t{1} << 32) / static_cast<std::uint64_t>(tile_size) + 1) {
  const auto width = static_cast<std::int32_t>(frame.width), height = static_cast<std::int32_t>(frame.height);
  columns = (width + size - 1) / size;
  for (std::int32_t y = 0; y < height; y += size)
    for (std::int32_t x = 0; x < width; x += size)
      tiles.push_back({x, y, std::min(x + size, width), std::min(y + size, height)});
}

std::vector<Band> split_into_bands(const SetupTriangles& triangles, const TileGrid& grid, const PairBytes& pair_bytes,
                                   int threads, std::uint64_t memory_limit) {
  const Band whole{0, grid.tiles.size()};
  if (memory_limit == 0 || most_bytes(triangles, grid, pair_bytes) <= memory_limit) return {whole};

  std::vector<Band> bands = {{0, 0}};
  Need need;
  for (std::size_t row = 0; row < grid.tiles.size(); row += static_cast<std::size_t>(grid.columns)) {
    const std::vector<TriangleList> lists =
        bin_triangles(triangles, grid, {row, row + static_cast<std::size_t>(grid.columns)});
    for (std::size_t i = 0; i < lists.size(); ++i) {
      const Tile& tile = grid.tiles[row + i];
      const std::uint64_t list = lists[i].size() * sizeof(std::uint32_t);
      const std::uint64_t pairs = bytes_of_pairs(triangles, lists[i], tile, pair_bytes);
      if (list + pairs > memory_limit) {
        throw std::runtime_error("the memory limit of " + mebibytes(memory_limit) + " is too low: the " +
                                 std::to_string(lists[i].size()) + " triangles at pixels " + std::to_string(tile.x0) +
                                 "," + std::to_string(tile.y0) + " to " + std::to_string(tile.x1 - 1) + "," +
                                 std::to_string(tile.y1 - 1) + " need " + mebibytes(list + pairs) + " at once");
      }
      Need with_tile = need;
      with_tile.add(list, pairs);
      if (with_tile.bytes(threads) > memory_limit) {
        bands.push_back({row + i, row + i});
        with_tile = {};
        with_tile.add(list, pairs);
      }
      need = with_tile;
      bands.back().last = row + i + 1;
    }
  }
  return bands;
}

std::vector<TriangleList> bin_triangles(const SetupTriangles& triangles, const TileGrid& grid, const Band& band) {
  // Each thread bins a chunk of the triangles; then the lists of the chunks are joined in order.
  const std::size_t count = triangles.triangles.size(), tiles = band.last - band.first;
  const auto chunks = static_cast<std::size_t>(tbb::this_task_arena::max_concurrency());
  const std::size_t chunk_size = count / chunks + 1;
  std::vector<std::vector<TriangleList>> found(chunks, std::vector<TriangleList>(tiles));
  tbb::parallel_for(std::size_t{0}, found.size(), [&](std::size_t chunk) {
    for (std::size_t i = chunk * chunk_size; i < std::min(count, (chunk + 1) * chunk_size); ++i)
      for_touched_tiles(triangles.triangles[i], grid, band, [&](std::size_t tile) {
        found[chunk][tile - band.first].push_back(static_cast<std::uint32_t>(i));
      });
  });
  if (found.size() == 1) return std::move(found.front());
  std::vector<TriangleList> lists(tiles);
  tbb::parallel_for(std::size_t{0}, tiles, [&](std::size_t tile) {
    for (const std::vector<TriangleList>& of_chunk : found)
      lists[tile].insert(lists[tile].end(), of_chunk[tile].begin(), of_chunk[tile].end());
  });
  return lists;
}

}  // namespace beampipe
