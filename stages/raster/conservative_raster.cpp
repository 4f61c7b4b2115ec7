#include "stages/raster/conservative_raster.h"

#include <algorithm>
#include <array>
#include <bit>

#include "simd/depth_bounds.h"
#include "simd/prefetch.h"
#include "stages/raster/conservative_raster_cost.h"
#include "stages/raster/traverse.h"

namespace beampipe {
namespace {

// Pixels that one triangle touches. Blocks of them get their bounds at once.
class TouchedPixels {
 public:
  TouchedPixels(const ConservativeOptions& options, std::vector<Pair>& out)
      : closed_(options.closed),
        has_bounds_(options.depths == PairDepths::bounds),
        closes_(options.closed && options.closing == Closing::by_raster),
        out_(out) {}

  // The pixels that are added next belong to this triangle.
  void start(std::uint32_t index, const SetupTriangle& triangle, const DepthBounds<float>& vertices, bool is_opaque) {
    index_ = index, triangle_ = &triangle, vertices_ = vertices, is_opaque_ = is_opaque;
  }

  // As traverse_quads() visits them.
  void add(std::int32_t left, std::int32_t top, const QuadRow& cells) {
    if (count_ + kMostCells > kBoundsBlock) finish();
    const std::uint64_t full = is_opaque_ ? cells.full : 0;
    for (std::uint64_t bits = cells.touched; bits != 0; bits &= bits - 1) {
      const int bit = std::countr_zero(bits);
      pixels_.x[count_] = left + column_of(bit), pixels_.y[count_] = top + row_of(bit);
      quads_[count_] = next_quad_ + static_cast<std::uint32_t>(bit >> 2);
      full_[count_] = (full >> bit & 1) != 0;
      ++count_;
    }
    next_quad_ += kQuadsPerRow;
  }

  // Hands on the pairs of the pixels that were added.
  void finish() {
    if (count_ == 0) return;
    if (has_bounds_) {
      find_pair_bounds(triangle_->depth, vertices_, count_, pixels_);
    } else {
      std::fill_n(pixels_.nearest, count_, 0.0f), std::fill_n(pixels_.farthest, count_, 0.0f);
    }
    // Nothing branches on what is hidden, which no processor predicts.
    find_hidden();
    std::array<Pair, kBoundsBlock> pairs;
    std::size_t kept = 0;
    for (std::size_t i = 0; i < count_; ++i) {
      pairs[kept] = {.triangle = index_,
                     .quad = quads_[i],
                     .x = pixels_.x[i],
                     .y = pixels_.y[i],
                     .full = full_[i],
                     .nearest = pixels_.nearest[i],
                     .farthest = pixels_.farthest[i]};
      kept += !hidden_[i];
    }
    out_.insert(out_.end(), pairs.begin(), pairs.begin() + static_cast<std::ptrdiff_t>(kept));
    touched_ += count_;
    count_ = 0;
  }

  std::uint64_t touched() const { return touched_; }

 private:
  static constexpr std::size_t kMostCells = 4 * kQuadsPerRow;  // that are added at once

  void find_hidden() {
    if (!closed_) {
      std::fill_n(hidden_.begin(), count_, false);
    } else if (closes_) {
      for (std::size_t i = 0; i < count_; ++i)
        hidden_[i] =
            closed_->hides_or_closes(pixels_.x[i], pixels_.y[i], pixels_.nearest[i], pixels_.farthest[i], full_[i]);
    } else {
      closed_->hides(pixels_.x, pixels_.y, pixels_.nearest, count_, hidden_.data());
    }
  }

  ClosedDepth* closed_;
  bool has_bounds_, closes_;
  std::vector<Pair>& out_;
  std::uint32_t index_ = 0;
  const SetupTriangle* triangle_ = nullptr;
  DepthBounds<float> vertices_{};
  bool is_opaque_ = false;
  std::uint32_t next_quad_ = 0;
  std::uint64_t touched_ = 0;  // by all triangles
  std::size_t count_ = 0;
  PixelBounds pixels_;
  std::array<std::uint32_t, kBoundsBlock> quads_;
  std::array<bool, kBoundsBlock> full_, hidden_;
};

}  // namespace

std::size_t conservative_raster(const SetupTriangles& triangles, const TriangleList& list, const Tile& tile,
                                StageCounters& counters, std::vector<Pair>& out, const ConservativeOptions& options) {
  ClosedDepth* const closed = options.closed;
  const std::size_t before = out.size();
  Traversal traversal{tile};
  ConservativeRasterWork work;
  TouchedPixels pixels(options, out);
  constexpr std::size_t kAhead = 6;  // triangles
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (i + kAhead < list.size()) prefetch(triangles.triangles[list[i + kAhead]]);
    const std::uint32_t index = list[i];
    const SetupTriangle& triangle = triangles.triangles[index];
    const DepthBounds<float> vertices = vertex_bounds(triangle.vertex_z);
    if (closed && closed->hides_everywhere(vertices.nearest)) continue;
    pixels.start(index, triangle, vertices, triangles.is_opaque(index));
    traverse_quads(triangle, EdgeSet(triangle), traversal,
                   [&](std::int32_t left, std::int32_t top, const QuadRow& cells) { pixels.add(left, top, cells); });
    pixels.finish();
    if (closed) closed->refresh();
  }
  const std::size_t waited = out.size();
  if (closed && options.closing == Closing::by_raster) {  // pixels may have been closed after a pair was found in them
    work.tested_again = waited;
    std::erase_if(out, [&](const Pair& pair) { return closed->hides(pair.x, pair.y, pair.nearest); });
  }
  if (closed) charge(*closed, counters);
  work.traversal = traversal.counts;
  work.traversal.cells_touched = pixels.touched();
  work.triangles = list.size();
  work.pairs = out.size() - before;
  charge(work, options.depths, counters);
  return waited;
}

}  // namespace beampipe
