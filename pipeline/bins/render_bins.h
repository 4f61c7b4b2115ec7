// Renders a frame bin by bin: sorts the triangles into bins, puts the bins onto threads, and adds up what they
// recorded. Pictures depend neither on the number of threads nor on the tile size. Counters do not depend on the number
// of threads; those of the modelled caches and of what is decided bin by bin depend on the tile size.
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "pipeline/bins/bin.h"
#include "pipeline/bins/frame_context.h"
#include "pipeline/memory/framebuffer.h"
#include "pipeline/technique.h"

namespace beampipe {

// How a technique renders its bins.
struct BinPlan {
  // Of a bin, in the order in which they run. Those for alpha are added where they belong; `blend` is left out of
  // frames without translucent triangles, unless they keep the API's order. A stage that runs twice is listed
  // where most of it runs.
  std::vector<StageId> stages;
  Framebuffer framebuffer;  // with the size of the bins, which FrameInput::tile_size overrides
  // The first pass over the geometry writes depth alone. Its stages (vertex_setup, sample_raster, alpha_test for
  // cutouts, depth_test) are counted apart from those of the other pass, as "prepass_vertex_setup" and so on.
  bool has_prepass = false;
  bool keeps_tile_size = false;  // it does not, because the picture depends on the bins
  // Bins sort their lists by keys, which binning writes beside the entries. They charge themselves for the setup that
  // the raster stage reads, because it reads it in sorted order.
  bool sorts_lists = false;
  // Bytes that this program keeps for each pair until the bin is finished (FrameInput::memory_limit). 0: the technique
  // works on a few triangles at a time.
  std::size_t pair_bytes = 0;
  std::size_t translucent_pair_bytes = 0;  // the same for pairs of translucent triangles, in addition
  // Bins without triangles are alike, and one of each size stands for all; unless they are not, because rendering one
  // depends on its place in the frame or leaves something outside it.
  bool empty_bins_differ = false;
  std::string order = "order of the trace";  // in which pixels take fragments, for PixelHistory
};

using BinRenderer = std::function<void(Bin&)>;

// `render` is called for every bin of the frame (but see BinPlan::empty_bins_differ), on any thread. vertex_setup runs
// once in each geometry pass, and the raster stage reads every setup triangle in each pass (from memory: each bin reads
// those of its list). Throws std::runtime_error if the technique needs bins and the modelled memory system has none.
FrameResult render_bins(const FrameContext& context, const BinPlan& plan, const BinRenderer& render);

// Runs a stage that reads whole frames and makes the pixels of one tile at a time, after all bins are finished. Adds
// its counters to the end of result.stages.
void run_on_tiles(const FrameContext& context, StageId stage, FrameResult& result,
                  const std::function<void(const Tile&, const BinStage&)>& work);

// Copies a tile's values, one per pixel, to their places in the frame's. Several tiles may do so at the same time.
template <class Value>
void copy_to_frame(const std::vector<Value>& tile_values, const Tile& tile, const Frame& frame,
                   std::vector<Value>& frame_values) {
  const Value* from = tile_values.data();
  for (std::int32_t y = tile.y0; y < tile.y1; ++y, from += tile.width())
    std::copy_n(from, tile.width(),
                frame_values.data() + static_cast<std::size_t>(y) * frame.width + static_cast<std::size_t>(tile.x0));
}

// Copies a frame's pixels, row by row, into its picture.
void copy_to_image(const std::vector<glm::vec4>& pixels, Image& image);

}  // namespace beampipe
