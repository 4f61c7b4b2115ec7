// What the inspection of a pixel starts from: the triangles of its bin, and those that touch it as pairs and fragments.
#pragma once

#include <optional>
#include <vector>

#include "pipeline/bins/frame_context.h"
#include "pipeline/inspect/pixel_history.h"
#include "stages/beam/beam_fragment.h"
#include "stages/data/closed_depth.h"
#include "stages/raster/conservative_raster.h"

namespace beampipe {

struct InspectedPixel {
  const FrameContext& context;
  PixelAddress at;
  Tile bin;           // that the pixel lies in
  Tile quad;          // the 2x2 quad that the pixel lies in, as far as it lies in the frame: what is rasterized
  Tile tile;          // the pixel alone: what is composed
  TriangleList list;  // of the bin, in primitive order

  // `bin_size`: pixels on each side of a bin. The context must outlive it.
  InspectedPixel(const FrameContext& frame_context, PixelAddress pixel, std::int32_t bin_size);

  TileShader shader() const { return {context.shader, tile}; }

  // The pairs of this pixel in the order of the list. `closed`: of the quad, or null.
  std::vector<Pair> pairs(const TriangleList& triangles, ClosedDepth* closed = nullptr,
                          Closing closing = Closing::by_later_stage) const;

  // A history in which nothing has happened yet. `positions`: of masks.
  PixelHistory history(const std::string& order, const std::vector<SamplePattern>& positions) const;

  // Adds the pair's triangle to the history, with its fragment, which is returned: not shaded, as pixel 0 of `tile`.
  // Nothing if it has no area or alpha leaves nothing of it.
  std::optional<Fragment> arrive(const Pair& pair, const BeamFragmentOptions& options, PixelHistory& history) const;

  // The triangle's exact part of the pixel, 0..1. Alpha is left out.
  double area_of(const Pair& pair) const;
};

// The same fragment as a part of a history: who it is, and where.
HistoryFragment history_fragment(const FrameContext& context, const Pair& pair);

// A frame's history at some pixels: inspect(InspectedPixel) for each. Nothing is modelled, recorded or timed.
// `bin_size`: as above; `keeps_bin_size`: FrameInput::tile_size does not replace it.
template <class Inspect>
std::vector<PixelHistory> inspect_pixels(const Trace& trace, const Frame& frame, const FrameInput& run,
                                         const ShadingRules& rules, std::int32_t bin_size, bool keeps_bin_size,
                                         const std::vector<PixelAddress>& pixels, Inspect&& inspect) {
  FrameInput plain;
  plain.threads = run.threads, plain.textures = run.textures, plain.colors = run.colors;
  plain.memory.modelled = false;
  const FrameContext context({trace, frame, plain, {}}, rules);
  const std::int32_t size = !keeps_bin_size && run.tile_size > 0 ? run.tile_size : bin_size;
  std::vector<PixelHistory> histories;
  for (const PixelAddress& pixel : pixels) histories.push_back(inspect(InspectedPixel(context, pixel, size)));
  return histories;
}

// Which bits of the mask are set, of the first `count`.
std::vector<bool> bits_of(const WideMask& mask, std::size_t count);

// Gives positions to a fragment: whose they were is noted with both fragments. `history.owners` must have all
// positions.
void take_positions(const WideMask& mask, std::uint32_t fragment, PixelHistory& history);

// Notes who has the positions that the fragment covers and has not taken, from position `first` on.
void note_missed(std::uint32_t fragment, PixelHistory& history, std::size_t first = 0);

}  // namespace beampipe
