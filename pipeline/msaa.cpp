#include "pipeline/msaa.h"

#include <algorithm>
#include <string>

#include "pipeline/tiles.h"
#include "stages/depth_test.h"
#include "stages/resolve.h"
#include "stages/sample_raster.h"
#include "stages/shade.h"
#include "stages/vertex_setup.h"

namespace beampipe {
namespace {

constexpr int kTileSamples = 1 << 16;         // that a tile holds: 512 KiB of depth and owners
constexpr std::size_t kBatchTriangles = 512;  // between raster and depth test, so that fragments stay in cache

int tile_size(int samples) {
  int size = 64;
  while (size > 2 && size * size * samples > kTileSamples) size /= 2;
  return size;
}

// Fragments per pixel: what one triangle contributes to one pixel, in however many cells of it.
class FragmentCounts {
 public:
  explicit FragmentCounts(const Tile& tile) : tile_(tile), counts_(tile.pixels()), last_(tile.pixels(), kNoTriangle) {}

  // Fragments of one triangle come one after the other.
  void add(const std::vector<SampleFragment>& fragments, const CellGrid& grid) {
    for (const SampleFragment& fragment : fragments) {
      const std::int32_t x = fragment.x / grid.columns - tile_.x0, y = fragment.y / grid.rows - tile_.y0;
      const auto pixel = static_cast<std::size_t>(y * tile_.width() + x);
      counts_[pixel] += last_[pixel] != fragment.triangle;
      last_[pixel] = fragment.triangle;
    }
  }
  std::vector<float> take() { return std::move(counts_); }

 private:
  const Tile& tile_;
  std::vector<float> counts_;
  std::vector<std::uint32_t> last_;  // triangle counted last
};

}  // namespace

Sampling msaa_sampling(int samples) {
  if (samples <= 16) return {CellGrid{}, standard_pattern(samples)};
  const CellCounts cells = split_into_cells(samples / 8);
  const CellGrid grid{cells.columns, cells.rows};
  return {grid, standard_pattern(8, grid.cell_width(), grid.cell_height())};
}

FrameResult render_msaa(const Trace& trace, const Frame& frame, int samples, const RunOptions& run) {
  StageCounters setup;
  const SetupTriangles triangles = vertex_setup(trace, frame, setup);
  const std::vector<glm::vec3> colors = round_to_half(shade_triangles(triangles, frame.light_direction));
  const Sampling sampling = msaa_sampling(samples);

  return render_tiles(
      frame, triangles, setup, tile_size(samples), run, [&](const Tile& tile, const TriangleList& list) {
        StageCounters raster{"sample_raster"}, shading{"shade"}, testing{"depth_test"}, resolving{"resolve"};
        SampleTile surface(tile, sampling);
        FragmentCounts counts(tile);
        std::vector<SampleFragment> fragments;
        for (std::size_t first = 0; first < list.size(); first += kBatchTriangles) {
          const auto begin = list.begin() + static_cast<std::ptrdiff_t>(first);
          const TriangleList batch(begin,
                                   begin + static_cast<std::ptrdiff_t>(std::min(kBatchTriangles, list.size() - first)));
          fragments.clear();
          sample_raster(triangles, batch, tile, sampling, raster, fragments);
          shade(fragments, shading);
          depth_test(triangles, fragments, tile, sampling, testing, surface);
          counts.add(fragments, sampling.grid);
        }
        return TileResult{resolve(surface, tile.pixels(), colors, frame.background, resolving),
                          {{"fragments", counts.take()}},
                          {raster, shading, testing, resolving}};
      });
}

std::vector<Surface> msaa_framebuffer(int samples) {
  const auto n = static_cast<std::uint32_t>(samples);
  const std::string times = " x " + std::to_string(samples);
  return {{"depth", "D32F" + times, n * kSampleDepthBytes}, {"color", "RGB16F" + times, n * kSampleColorBytes}};
}

}  // namespace beampipe
