#include "pipeline/techniques/z3.h"

#include <stdexcept>
#include <string>

#include "pipeline/batches.h"
#include "pipeline/memory/beam_memory.h"
#include "pipeline/memory/geometry_memory.h"
#include "pipeline/memory/image_memory.h"
#include "pipeline/tiles.h"
#include "pipeline/timeline.h"
#include "stages/beam/beam_fragment.h"
#include "stages/geometry/vertex_setup.h"
#include "stages/picture/shade.h"
#include "stages/raster/conservative_raster.h"

namespace beampipe {
namespace {

template <std::size_t Words, std::size_t Layers>
FrameResult render_shape(const Trace& trace, const Frame& frame, const Z3Options& z3, const RunOptions& run) {
  StageCounters setup;
  const SetupTriangles triangles = vertex_setup(trace, frame, StageTimer(run.timeline)(setup));
  const std::vector<glm::vec3> colors = shade_triangles(triangles, frame.light_direction);
  const PositionSet& positions = cell_positions(z3.positions);
  const PositionGrid grid(z3.positions);
  const BeamFragmentOptions options = grid_options(grid, 4 + 4 * Words + 12);

  return render_tiles(frame, triangles, setup, kBinSize, run, [&](const Tile& tile, const TriangleList& list) {
    const StageTimer timed(run.timeline, tile);
    StageCounters raster{"conservative_raster"}, fragment{"beam_fragment"}, shading{"shade"}, composition{"compose"},
        resolving{"resolve"};
    std::vector<Z3Pixel<Words, Layers>> pixels(tile.pixels());
    std::vector<float> counts(tile.pixels()), merges(tile.pixels()), bytes(tile.pixels());
    const ZOrder order(tile.width(), tile.height());
    AggregateMemory memory(run.memory, order, z3_framebuffer(z3));
    AttributesInOrder attributes(run.memory);
    BinBuffers held;
    std::vector<PixelTriangle> pairs;
    std::vector<Fragment> fragments;
    for_each_batch(list, [&](const TriangleList& batch) {
      pairs.clear(), fragments.clear();
      conservative_raster(triangles, batch, tile, timed(raster), pairs);
      beam_fragment(triangles, pairs, tile, options, timed(fragment), fragments);
      held.holds("batch_pairs", pairs.size() * kPairWithDepthBytes);
      held.holds("batch_fragments", fragments.size() * options.fragment_bytes);
      shade(colors, fragments, timed(shading), &triangles.attributes);
      attributes.read(fragments, shading);
      for (const Fragment& item : fragments) ++counts[item.pixel];
      compose_z3(fragments, positions, z3.merge, timed(composition), pixels, merges);
      for (const Fragment& item : fragments) memory.merge(item.triangle, item.pixel, composition);
    });
    memory.flush({}, composition);
    memory.add_bytes(bytes);
    memory.read_all(resolving);
    write_image(run.memory, tile, resolving);
    return TileResult{resolve(z3_colors(pixels), frame.background, sizeof pixels[0], timed(resolving)),
                      {{"fragments", std::move(counts)}, {"merges", std::move(merges)}, {"bytes", std::move(bytes)}},
                      {raster, fragment, shading, composition, resolving},
                      held};
  });
}

}  // namespace

FrameResult render_z3(const Trace& trace, const Frame& frame, const Z3Options& z3, const RunOptions& run) {
#define BEAMPIPE_RENDER(words, shape_layers)                   \
  if (z3.positions == 32 * words && z3.layers == shape_layers) \
    return render_shape<words, shape_layers>(trace, frame, z3, run);
  BEAMPIPE_Z3_PIXELS(BEAMPIPE_RENDER)
#undef BEAMPIPE_RENDER
  throw std::invalid_argument("no pixel of this shape: " + std::to_string(z3.positions) + " positions, " +
                              std::to_string(z3.layers) + " layers");
}

std::vector<Surface> z3_framebuffer(const Z3Options& z3) {
  const auto words = static_cast<std::uint32_t>(z3.positions / 32), layers = static_cast<std::uint32_t>(z3.layers);
  const std::string times = " x " + std::to_string(layers);
  return {{"owner_map", "R32UI x " + std::to_string(2 * words), 8 * words},
          {"depth", "R32F" + times, 4 * layers},
          {"slopes", "RG16BF" + times, 4 * layers},
          {"color", "RGB16F" + times, 6 * layers}};
}

}  // namespace beampipe
