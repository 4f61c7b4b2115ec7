#include "pipeline/techniques/beam.h"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "pipeline/memory/beam_memory.h"
#include "pipeline/memory/geometry_memory.h"
#include "pipeline/tiles.h"
#include "pipeline/timeline.h"
#include "stages/beam/a_buffer.h"
#include "stages/beam/beam_fragment.h"
#include "stages/beam/compose_beam.h"
#include "stages/beam/windows.h"
#include "stages/geometry/vertex_setup.h"
#include "stages/picture/resolve.h"
#include "stages/picture/shade.h"
#include "stages/raster/conservative_raster.h"

namespace beampipe {
namespace {

// That a pair takes until its tile is done; its window may be all of them.
constexpr std::size_t kBufferedBytes = kPairBytes + kSortBytes;

// What the tiles of a frame have in common.
struct BeamFrame {
  StageCounters setup;
  SetupTriangles triangles;
  std::vector<glm::vec3> colors;
  const PositionSet& positions;
  PositionGrid grid;
  BeamFragmentOptions options;

  BeamFrame(const Trace& trace, const Frame& frame, int count, const RunOptions& run)
      : triangles(vertex_setup(trace, frame, StageTimer(run.timeline)(setup))),
        colors(shade_triangles(triangles, frame.light_direction)),
        positions(cell_positions(count)),
        grid(count),
        options(grid_options(grid, conserving_fragment_bytes(count))) {}
};

template <std::size_t Words, class Channel>
FrameResult render_shape(const Trace& trace, const Frame& frame, const BeamOptions& beam, const RunOptions& run) {
  BeamFrame state(trace, frame, beam.positions, run);
  FrameResult result = render_tiles(
      frame, state.triangles, state.setup, kBinSize, run, kBufferedBytes,
      [&](const Tile& tile, const TriangleList& list) {
        const StageTimer timed(run.timeline, tile);
        StageCounters raster{"conservative_raster"}, buffering{"a_buffer"}, windowing{"windows"},
            fragment{"beam_fragment"}, shading{"shade"}, composition{"compose"}, resolving{"resolve"};
        std::vector<StoredAggregate<Words, Channel>> pixels(tile.pixels());
        std::vector<PixelTriangle> pairs, window, whole;
        std::vector<Fragment> fragments;
        std::vector<float> areas, tiny(tile.pixels());
        ClosedDepth closed(tile);
        BinBuffers held;
        const std::size_t waited = conservative_raster(state.triangles, list, tile, timed(raster), pairs, &closed);
        held.holds("waiting_pairs", waited * kPairWithDepthBytes);
        held.holds("closed_depth", closed.bytes());
        const std::vector<SortRecord> records = sort_records(pairs, tile);
        const ABuffer buffer =
            a_buffer(records, tile.pixels(), kPairWithDepthBytes, kWaitingPairBytes, timed(buffering));
        Windows windows(pairs, buffer, kWaitingPairBytes);
        TriangleFetches fetches(run.memory, list);
        while (windows.next([&](std::uint32_t pixel) { return !is_closed(pixels[pixel]); }, timed(windowing), window,
                            whole)) {
          fragments.clear();
          beam_fragment(state.triangles, window, tile, state.options, timed(fragment), fragments);
          held.holds("window_pairs", (window.size() + whole.size()) * kPairWithDepthBytes);
          held.holds("window_fragments", fragments.size() * state.options.fragment_bytes);
          shade_visible(state.colors, fragments, timed(shading), &state.triangles.attributes);
          fetches.setup(window, fragment);
          fetches.attributes(fragments, shading);
          compose_window(fragments, state.positions, timed(composition), pixels, areas);
          shade_visible(whole, timed(shading), &state.triangles.attributes);
          fetches.attributes(whole, shading);
          compose_whole(whole, tile, state.colors, timed(composition), pixels);
          for (const Fragment& item : fragments) tiny[item.pixel] += item.tiny;
        }
        std::vector<float> bytes = count_sorted_composition(
            run.memory, tile, buffer, records, kWaitingPairBytes, windows.looked_at, covered_pixels(pixels),
            closed_pixels(pixels), beam_framebuffer(beam), buffering, windowing, composition, resolving);
        fetches.flush(shading);
        return TileResult{resolve(composed_colors(pixels), frame.background, sizeof pixels[0], timed(resolving)),
                          {{"fragments", depths_of(buffer)},
                           {"tiny_triangles", std::move(tiny)},
                           {"largest_window", std::move(windows.largest)},
                           {"merges", std::move(windows.taken)},
                           {"bytes", std::move(bytes)}},
                          {raster, buffering, windowing, fragment, shading, composition, resolving},
                          held};
      });
  const auto buffering = std::find_if(result.stages.begin(), result.stages.end(),
                                      [](const StageCounters& stage) { return stage.stage == "a_buffer"; });
  result.a_buffer_peak_bytes =
      a_buffer_bytes(buffering->items_in, std::uint64_t{frame.width} * frame.height, kWaitingPairBytes);
  return result;
}

template <std::size_t Words>
std::vector<PixelWeights> weights_of(const Trace& trace, const Frame& frame, const BeamOptions& beam,
                                     const RunOptions& run) {
  const BeamFrame state(trace, frame, beam.positions, run);
  std::vector<PixelWeights> weights(std::size_t{frame.width} * frame.height);
  render_tiles(
      frame, state.triangles, state.setup, kBinSize, run, kBufferedBytes,
      [&](const Tile& tile, const TriangleList& list) {
        StageCounters unused{"weights"};
        std::vector<StoredAggregate<Words, float>> pixels(tile.pixels());  // as they are before colours are packed
        std::vector<PixelTriangle> pairs, window, whole;
        std::vector<Fragment> fragments;
        std::vector<float> areas;
        std::vector<PixelWeights> found(tile.pixels());
        ClosedDepth closed(tile);
        conservative_raster(state.triangles, list, tile, unused, pairs, &closed);
        const ABuffer buffer = a_buffer(sort_records(pairs, tile), tile.pixels(), 0, kWaitingPairBytes, unused);
        Windows windows(pairs, buffer, kWaitingPairBytes);
        while (windows.next([&](std::uint32_t pixel) { return !is_closed(pixels[pixel]); }, unused, window, whole)) {
          fragments.clear();
          beam_fragment(state.triangles, window, tile, state.options, unused, fragments);
          compose_window(fragments, state.positions, unused, pixels, areas);
          compose_whole(whole, tile, state.colors, unused, pixels);
          for (const PixelTriangle& pair : whole) found[tile.index(pair.x, pair.y)] = {{pair.triangle, 1.0f, 0, false}};
          for (std::size_t i = 0; i < fragments.size(); ++i)
            found[fragments[i].pixel].push_back({fragments[i].triangle, areas[i], 0, fragments[i].tiny});
        }
        for (std::size_t i = 0; i < tile.pixels(); ++i) {
          if (!is_closed(pixels[i])) continue;
          float sum = 0;  // a closed pixel's areas are scaled to 1
          for (const SurfaceWeight& surface : found[i]) sum += surface.weight;
          for (SurfaceWeight& surface : found[i]) surface.weight /= sum;
        }
        copy_to_frame(found, tile, frame, weights);
        return TileResult{{}, {}, {unused}};
      });
  return weights;
}

}  // namespace

FrameResult render_beam(const Trace& trace, const Frame& frame, const BeamOptions& beam, const RunOptions& run) {
#define BEAMPIPE_RENDER(words, channel)                                                                       \
  if (beam.positions == 32 * words && (beam.storage == Storage::packed) == std::is_same_v<channel, HalfBits>) \
    return render_shape<words, channel>(trace, frame, beam, run);
  BEAMPIPE_STORED_AGGREGATES(BEAMPIPE_RENDER)
#undef BEAMPIPE_RENDER
  throw std::invalid_argument("no aggregate of " + std::to_string(beam.positions) + " positions");
}

std::vector<PixelWeights> beam_weights(const Trace& trace, const Frame& frame, const BeamOptions& beam,
                                       const RunOptions& run) {
  switch (beam.positions) {
    case 32:
      return weights_of<1>(trace, frame, beam, run);
    case 64:
      return weights_of<2>(trace, frame, beam, run);
    case 128:
      return weights_of<4>(trace, frame, beam, run);
    default:
      return weights_of<8>(trace, frame, beam, run);
  }
}

std::vector<Surface> beam_framebuffer(const BeamOptions& beam) {
  const auto mask_bytes = static_cast<std::uint32_t>(beam.positions) / 8;
  return {{"coverage", "R32F", 4},
          {"mask", "R32UI x " + std::to_string(mask_bytes / 4), mask_bytes},
          beam.storage == Storage::packed ? Surface{"color", "RGB16F", 6} : Surface{"color", "RGB32F", 12}};
}

}  // namespace beampipe
