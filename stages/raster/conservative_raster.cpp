#include "stages/raster/conservative_raster.h"

#include <algorithm>
#include <array>

#include "simd/prefetch.h"
#include "simd/touched_pixels.h"
#include "stages/raster/conservative_raster_cost.h"
#include "stages/raster/traverse.h"

namespace beampipe {
namespace {

// Makes the pairs of one triangle after the other, of several rows of quads at once.
class PairBlock {
 public:
  PairBlock(const ConservativeOptions& options, std::vector<Pair>& out) : options_(options), out_(out) {}

  // The rows that are added next belong to this triangle.
  void start(std::uint32_t index, const SetupTriangle& triangle, const DepthBounds<float>& vertices, bool is_opaque) {
    index_ = index, triangle_ = &triangle, vertices_ = vertices, is_opaque_ = is_opaque;
  }

  // As traverse_quads() visits them.
  void add(std::int32_t x, std::int32_t y, const QuadRow& pixels) {
    if (count_ == kRowsInBlock) finish();
    rows_[count_++] = {x, y, quad_, pixels};
    quad_ += kQuadsPerRow;
  }

  // Hands on the pairs of the rows that were added.
  void finish() {
    const std::size_t pixels = touched_pixels(rows_.data(), count_, triangle_->depth, vertices_, pixels_);
    if (options_.depths == PairDepths::none)
      std::fill_n(pixels_.nearest, pixels, 0.0f), std::fill_n(pixels_.farthest, pixels, 0.0f);
    find_hidden(pixels);
    std::size_t kept = 0;
    for (std::size_t i = 0; i < pixels; ++i) {  // without branches on what is hidden, which no processor predicts
      pairs_[kept] = {.triangle = index_,
                      .quad = pixels_.quad[i],
                      .x = pixels_.x[i],
                      .y = pixels_.y[i],
                      .full = is_full(i),
                      .nearest = pixels_.nearest[i],
                      .farthest = pixels_.farthest[i]};
      kept += !hidden_[i];
    }
    out_.insert(out_.end(), pairs_.begin(), pairs_.begin() + static_cast<std::ptrdiff_t>(kept));
    touched_ += pixels;
    count_ = 0;
  }

  std::uint64_t touched() const { return touched_; }

 private:
  bool is_full(std::size_t i) const { return is_opaque_ & (pixels_.full[i] != 0); }

  void find_hidden(std::size_t pixels) {
    ClosedDepth* const closed = options_.closed;
    if (!closed) {
      std::fill_n(hidden_.begin(), pixels, false);
    } else if (options_.closing == Closing::by_later_stage) {
      closed->hides(pixels_.x, pixels_.y, pixels_.nearest, pixels, hidden_.data());
    } else {
      std::uint64_t hidden = 0, closings = 0;
      for (std::size_t i = 0; i < pixels; ++i) {
        hidden_[i] =
            closed->hides_or_closes(pixels_.x[i], pixels_.y[i], pixels_.nearest[i], pixels_.farthest[i], is_full(i));
        hidden += hidden_[i], closings += is_full(i) & !hidden_[i];
      }
      closed->count(pixels, hidden, closings);
    }
  }

  ConservativeOptions options_;
  std::vector<Pair>& out_;
  std::uint32_t index_ = 0, quad_ = 0;
  const SetupTriangle* triangle_ = nullptr;
  DepthBounds<float> vertices_{};
  bool is_opaque_ = false;
  std::uint64_t touched_ = 0;  // pixels, of all triangles
  std::size_t count_ = 0;
  std::array<PixelRow, kRowsInBlock> rows_;
  TouchedPixels pixels_;
  std::array<bool, kPixelsInBlock> hidden_;
  std::array<Pair, kPixelsInBlock> pairs_;
};

}  // namespace

std::size_t conservative_raster(const SetupTriangles& triangles, const TriangleList& list, const Tile& tile,
                                StageCounters& counters, std::vector<Pair>& out, const ConservativeOptions& options) {
  ClosedDepth* const closed = options.closed;
  const std::size_t before = out.size();
  Traversal traversal{tile};
  ConservativeRasterWork work;
  PairBlock pairs(options, out);
  constexpr std::size_t kAhead = 6;  // triangles
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (i + kAhead < list.size()) prefetch(triangles.triangles[list[i + kAhead]]);
    const std::uint32_t index = list[i];
    const SetupTriangle& triangle = triangles.triangles[index];
    const DepthBounds<float> vertices = vertex_bounds(triangle.vertex_z);
    if (closed && closed->hides_everywhere(vertices.nearest)) continue;
    pairs.start(index, triangle, vertices, triangles.is_opaque(index));
    traverse_quads(triangle, EdgeSet(triangle), traversal,
                   [&](std::int32_t x, std::int32_t y, const QuadRow& cells) { pairs.add(x, y, cells); });
    pairs.finish();
    if (closed) closed->refresh();
  }
  const std::size_t waited = out.size();
  if (closed && options.closing == Closing::by_raster) {  // pixels may have been closed after a pair was found in them
    work.tested_again = waited;
    std::erase_if(out, [&](const Pair& pair) { return closed->hides(pair.x, pair.y, pair.nearest); });
  }
  if (closed) charge(*closed, counters);
  work.traversal = traversal.counts;
  work.traversal.cells_touched = pairs.touched();
  work.triangles = list.size();
  work.pairs = out.size() - before;
  charge(work, options.depths, counters);
  return waited;
}

}  // namespace beampipe
