// Runs the stages around compose_pooled one after the other, for a tile of open pixels.
#pragma once

#include "stages/beam/beam_fragment.h"
#include "stages/beam/compose_pooled.h"
#include "stages/raster/bin_sort.h"
#include "stages/raster/conservative_raster.h"
#include "tests/stages/screen_triangles.h"

namespace beampipe {

// The fragments of the list's triangles, in its order.
template <std::size_t Words>
std::vector<Fragment> fragments_in_order(const SetupTriangles& triangles, const TriangleList& list, const Tile& tile) {
  const PositionGrid grid(32 * static_cast<int>(Words));
  StageCounters ignored;
  std::vector<Pair> pairs;
  std::vector<Fragment> fragments;
  conservative_raster(triangles, list, tile, ignored, pairs);
  beam_fragment(triangles, pairs, tile, grid_options(grid, owners_fragment_bytes(Words), kOwnersWholeFragmentBytes),
                ignored, fragments);
  return fragments;
}

// A colour for each triangle, whose channels lie from `least` to `greatest`.
inline std::vector<glm::vec3> random_colors(const SetupTriangles& triangles, Random& random, double least = 0,
                                            double greatest = 1) {
  std::vector<glm::vec3> colors;
  for (std::size_t i = 0; i < triangles.triangles.size(); ++i)
    colors.emplace_back(random.real32(least, greatest), random.real32(least, greatest), random.real32(least, greatest));
  return colors;
}

// `tolerance`: of alpha and of each channel.
inline void expect_pixel(const PixelColor& found, double alpha, const glm::dvec3& color, double tolerance) {
  EXPECT_NEAR(found.alpha, alpha, tolerance);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(found.color[c], color[c], tolerance) << "channel " << c;
}

// A tile of pixels with at most so many owners each, and a pool.
template <std::size_t Words, std::size_t Owners = kMostOwners>
struct OpenTile {
  static constexpr int kPositions = 32 * static_cast<int>(Words);

  const SetupTriangles& triangles;
  const std::vector<glm::vec3>& colors;
  Tile tile;
  const PositionSet& positions = cell_positions(kPositions);
  PooledPixels<Words> pixels;
  ClosedDepth closed;
  std::vector<float> counts, merges;       // per pixel: fragments that no closed pixel hid, owners that became one
  std::vector<Fragment> fragments;         // all that were composed
  StageCounters composing{}, finishing{};  // counted by compose_pooled and finish_pooled
  std::vector<float> chunks_in_memory, record_bytes, refusals, lost_specks;
  PooledResult result;
  ChunkRequests spills_of_composing;
  const PixelObservers* observers = nullptr;  // null: nobody looks
  const SurfaceShader* shader = nullptr;      // null: triangles are flat

  OpenTile(const SetupTriangles& of, const std::vector<glm::vec3>& in_colors, const Tile& in = {0, 0, 1, 1},
           const ChunkPool& pool = ChunkPool(1 << 20))
      : triangles(of),
        colors(in_colors),
        tile(in),
        pixels(in.pixels(), pool, Owners),
        closed(in),
        counts(in.pixels()),
        merges(in.pixels()),
        chunks_in_memory(in.pixels()),
        record_bytes(in.pixels()),
        refusals(in.pixels()),
        lost_specks(in.pixels()),
        result({chunks_in_memory, record_bytes, &refusals, &lost_specks}) {}

  // Composes the triangles of the list, in its order. `watermarks` may be null.
  std::vector<PixelColor> compose(const TriangleList& list, const std::vector<float>* watermarks = nullptr) {
    fragments = fragments_in_order<Words>(triangles, list, tile);
    const TileShader of_tile = shader ? TileShader(*shader, tile) : TileShader(colors);
    const OwnersBin bin{triangles, list, watermarks, tile, positions, of_tile, false, {}, observers};
    compose_pooled(bin, {fragments, 0}, composing, PooledTile<Words>{pixels, closed, {counts, merges}, result});
    spills_of_composing = result.spills;
    return finish_pooled(bin, finishing, pixels, result);
  }
  // Without watermarks that move on, nothing is final before the end.
  std::vector<PixelColor> compose_sorted(bool with_watermarks = true) {
    StageCounters ignored;
    OrderedList ordered = bin_sort(triangles, all_of(triangles), tile, ignored);
    if (!with_watermarks) ordered.watermarks.assign(ordered.triangles.size(), kInFront);
    return compose(ordered.triangles, &ordered.watermarks);
  }
};

}  // namespace beampipe
