#include "pipeline/techniques/beam_stream.h"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "pipeline/batches.h"
#include "pipeline/memory/beam_memory.h"
#include "pipeline/memory/geometry_memory.h"
#include "pipeline/memory/image_memory.h"
#include "pipeline/tiles.h"
#include "pipeline/timeline.h"
#include "stages/beam/beam_fragment.h"
#include "stages/beam/claim.h"
#include "stages/beam/settle.h"
#include "stages/cost/closed_depth_cost.h"
#include "stages/geometry/vertex_setup.h"
#include "stages/picture/shade.h"
#include "stages/raster/conservative_raster.h"

namespace beampipe {
namespace {

// A later pass over a bin: its list, its triangles' setup and what it has closed stand in memory and are read again.
void replay(const MemoryParameters& memory, const TriangleList& list, const ClosedDepth& closed,
            StageCounters& raster) {
  stream(memory, closed.bytes(), raster);
  raster.items_in += list.size();
  raster.bytes_read += list.size() * sizeof(SetupTriangle);
  read_bin(memory, list, raster);
}

// Moves the state of each pixel that has owners, once; their fragments stand pixel by pixel.
void move_settled(const std::vector<Fragment>& fragments, AggregateMemory& memory, StageCounters& counters) {
  for (std::size_t i = 0; i < fragments.size(); ++i)
    if (i == 0 || fragments[i].pixel != fragments[i - 1].pixel) memory.merge(0, fragments[i].pixel, counters);
}

template <std::size_t Words, std::size_t Layers>
FrameResult render_shape(const Trace& trace, const Frame& frame, const StreamOptions& stream, const RunOptions& run) {
  StageCounters setup;
  const SetupTriangles triangles = vertex_setup(trace, frame, StageTimer(run.timeline)(setup));
  const std::vector<glm::vec3> colors = shade_triangles(triangles, frame.light_direction);
  const PositionSet& positions = cell_positions(stream.positions);
  const PositionGrid grid(stream.positions);
  const BeamFragmentOptions options = grid_options(grid, streaming_fragment_bytes(Words));

  const TileRenderer render_tile = [&](const Tile& tile, const TriangleList& list) {
    const StageTimer timed(run.timeline, tile);
    StageCounters raster{"conservative_raster"}, fragment{"beam_fragment"}, claiming{"claim"}, shading{"shade"},
        settling{"settle"}, resolving{"resolve"};
    std::vector<OwnerPixel<Words, Layers>> pixels(tile.pixels(), cleared_pixel<Words, Layers>());
    std::vector<float> passes(tile.pixels()), counts(tile.pixels()), bytes(tile.pixels());
    BinBuffers held;
    std::vector<PixelTriangle> pairs;
    std::vector<Fragment> fragments;
    std::vector<std::uint32_t> remade;
    const ZOrder order(tile.width(), tile.height());
    const std::vector<Surface> framebuffer = stream_framebuffer(stream);
    AggregateMemory state(run.memory, order, {framebuffer.begin(), framebuffer.end() - 1});
    AggregateMemory color(run.memory, order, {framebuffer.back()});
    ClosedDepth closed(tile);
    held.holds("closed_depth", closed.bytes());
    Tile box = tile;
    TriangleFetches fetches(run.memory, list);
    for (int pass = 1; box.x0 < box.x1; ++pass) {
      if (pass > 1) replay(run.memory, list, closed, raster);
      for (std::size_t i = 0; i < pixels.size(); ++i) passes[i] += is_unfinished(pixels[i]);
      fetches.load_setup();
      for_each_batch(list, [&](const TriangleList& batch) {
        pairs.clear(), fragments.clear();
        const std::size_t waited = conservative_raster(triangles, batch, box, timed(raster), pairs, &closed);
        beam_fragment(triangles, pairs, tile, options, timed(fragment), fragments);
        held.holds("batch_pairs", waited * kPairWithDepthBytes);
        held.holds("batch_fragments", fragments.size() * options.fragment_bytes);
        if (pass == 1)
          for (const Fragment& item : fragments) ++counts[item.pixel];
        remade.clear();
        claim(triangles, fragments, tile, positions, timed(claiming), pixels, run.memory.modelled ? &remade : nullptr);
        if (run.memory.modelled)
          for (const Fragment& item : fragments) state.merge(item.triangle, item.pixel, claiming);
        for (const std::uint32_t owner : remade) fetches.depth(owner, claiming);
      });
      fetches.flush(claiming);
      state.flush({}, claiming);
      fragments.clear();
      const std::vector<PixelTriangle> owned = owners(triangles, pixels, tile, timed(settling));
      beam_fragment(triangles, owned, tile, options, timed(fragment), fragments);
      held.holds("owner_fragments", fragments.size() * options.fragment_bytes);
      shade_visible(colors, fragments, timed(shading), &triangles.attributes);
      fetches.setup(owned, fragment);
      fetches.attributes(fragments, shading);
      fetches.flush(shading);
      settle(fragments, pass == stream.passes, timed(settling), pixels);
      if (run.memory.modelled) {
        move_settled(fragments, state, settling);
        move_settled(fragments, color, settling);
      }
      state.flush({}, settling);
      color.flush({}, settling);
      close_finished(pixels, tile, closed);
      charge(closed, settling);
      box = unfinished_box(pixels, tile);
      if (box.x0 < box.x1) beampipe::stream(run.memory, closed.bytes(), settling);  // for the next pass
    }
    state.add_bytes(bytes);
    color.add_bytes(bytes);
    color.read_all(resolving);
    write_image(run.memory, tile, resolving);
    return TileResult{
        resolve(settled_colors(pixels), frame.background, framebuffer.back().bytes_per_pixel, timed(resolving)),
        {{"fragments", std::move(counts)}, {"passes", std::move(passes)}, {"bytes", std::move(bytes)}},
        {raster, fragment, claiming, shading, settling, resolving},
        held};
  };
  return render_tiles(frame, triangles, setup, kBinSize, run, render_tile);
}

}  // namespace

FrameResult render_stream(const Trace& trace, const Frame& frame, const StreamOptions& stream, const RunOptions& run) {
#define BEAMPIPE_RENDER(words, shape_layers)                           \
  if (stream.positions == 32 * words && stream.layers == shape_layers) \
    return render_shape<words, shape_layers>(trace, frame, stream, run);
  BEAMPIPE_OWNER_PIXELS(BEAMPIPE_RENDER)
#undef BEAMPIPE_RENDER
  throw std::invalid_argument("no pixel of this shape: " + std::to_string(stream.positions) + " positions, " +
                              std::to_string(stream.layers) + " layers");
}

std::vector<Surface> stream_framebuffer(const StreamOptions& stream) {
  const auto words = static_cast<std::uint32_t>(stream.positions / 32),
             layers = static_cast<std::uint32_t>(stream.layers);
  const std::uint32_t state_bytes = 4 * words * (layers == 1 ? 2 : 3);
  return {{"owner_map", "R32UI x " + std::to_string(state_bytes / 4), state_bytes},
          {"owners", "R32UI x " + std::to_string(layers), 4 * layers},
          {"dropped_depth", "R32F", 4},
          {"color", "RGB16F + R16", 8}};
}

}  // namespace beampipe
