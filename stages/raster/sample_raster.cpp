#include "stages/raster/sample_raster.h"

#include <algorithm>
#include <array>
#include <bit>

#include "simd/prefetch.h"
#include "simd/sample_mask.h"
#include "stages/data/pixel_depth.h"
#include "stages/raster/sample_raster_cost.h"
#include "stages/raster/traverse.h"

namespace beampipe {
namespace {

GridEdges grid_edges(const EdgeSet& set, const CellGrid& grid) {
  GridEdges edges;
  for (std::size_t k = 0; k < 3; ++k) {
    const Edge& edge = set.edges[k];
    edges.a[k] = edge.a, edges.b[k] = edge.b;
    edges.right[k] = static_cast<double>(std::int64_t{edge.a} * grid.cell_width());
    edges.down[k] = static_cast<double>(std::int64_t{edge.b} * grid.cell_height());
    edges.start[k] = static_cast<double>(edge.c - (edge.owns ? 0 : 1));
  }
  return edges;
}

// The cells of some triangles, before the samples of the partial ones are tested: in blocks, which stay in the nearest
// cache.
class CellBlock {
 public:
  CellBlock(const SampledTriangles& in, ClosedDepth* closed, std::vector<SampleFragment>& out, SampleRasterWork& work)
      : sampling_(in.sampling),
        every_sample_(~0u >> (kMaxMaskSamples - in.sampling.pattern.count)),
        closed_(closed),
        out_(out),
        work_(work) {}

  // The rows that are added next belong to this triangle.
  void start(std::uint32_t triangle, const EdgeSet& set, const DepthBounds<float>& depths, bool is_opaque) {
    if (triangles_ == kTriangles) finish();
    edges_[triangles_++] = grid_edges(set, sampling_.grid);
    triangle_ = triangle, closing_ = {depths.nearest, depths.farthest, is_opaque};
  }

  // As traverse_quads() visits them.
  void add(std::int32_t x, std::int32_t y, const QuadRow& cells) {
    if (count_ == kRows) finish();
    rows_[count_] = {x, y, cells.touched, cells.full};
    origins_[count_] = {triangle_, static_cast<std::uint32_t>(triangles_ - 1), quad_};
    count_ += cells.touched != 0;
    quad_ += kQuadsPerRow;
  }

  // Leaves out the cells where the triangle that was started last is hidden.
  void hide() {
    ClosingRow* const rows = &rows_[tested_];
    const std::size_t count = count_ - tested_;
    tested_ = count_;
    if (closed_) {
      visible_ += closed_->hides_or_closes(closing_, rows, count);
    } else {
      for (std::size_t i = 0; i < count; ++i) visible_ += static_cast<std::size_t>(std::popcount(rows[i].visible));
    }
  }

  // Tests the samples of the partial cells, and hands on the fragments that have any.
  void finish() {
    hide();
    const std::size_t before = out_.size();
    out_.resize(before + visible_ + 1);
    SampleFragment* to = out_.data() + before;
    for (std::size_t first = 0, end = 0; first < count_; first = end) {
      std::size_t partial = 0;
      for (; end < count_ && partial + 4 * kQuadsPerRow <= kCells; ++end) {
        const ClosingRow& row = rows_[end];
        for (std::uint64_t bits = row.visible & ~row.full; bits != 0; bits &= bits - 1) {
          const int bit = std::countr_zero(bits);
          cells_[partial++] = {origins_[end].edges, row.x + column_of(bit), row.y + row_of(bit)};
        }
      }
      work_.covered_samples += sample_masks(edges_.data(), cells_.data(), partial, sampling_.pattern, masks_.data());
      work_.partial_cells += partial;
      to = put_fragments(first, end, to);
    }
    out_.resize(static_cast<std::size_t>(to - out_.data()));
    if (triangles_ > 0) edges_[0] = edges_[triangles_ - 1];  // its cells may go on
    count_ = tested_ = visible_ = 0;
    triangles_ = std::min<std::size_t>(triangles_, 1);
  }

 private:
  static constexpr std::size_t kTriangles = 64, kRows = 64, kCells = 256;

  struct Origin {
    std::uint32_t triangle, edges, quad;
  };

  // Of rows [first, end), whose partial cells have the masks. Returns where the next ones go.
  SampleFragment* put_fragments(std::size_t first, std::size_t end, SampleFragment* to) const {
    const std::uint32_t* mask = masks_.data();
    for (std::size_t i = first; i < end; ++i) {
      const ClosingRow& row = rows_[i];
      const Origin& origin = origins_[i];
      for (std::uint64_t bits = row.visible; bits != 0; bits &= bits - 1) {
        const int bit = std::countr_zero(bits);
        const bool full = (row.full >> bit & 1) != 0;
        const std::uint32_t tested = *mask, samples = full ? every_sample_ : tested;  // nothing to predict
        *to = {origin.triangle, origin.quad + static_cast<std::uint32_t>(bit >> 2), row.x + column_of(bit),
               row.y + row_of(bit), samples};
        mask += !full;
        to += samples != 0;
      }
    }
    return to;
  }

  const Sampling& sampling_;
  std::uint32_t every_sample_;
  ClosedDepth* closed_;
  std::vector<SampleFragment>& out_;
  SampleRasterWork& work_;

  std::uint32_t triangle_ = 0, quad_ = 0;
  ClosingTriangle closing_{};
  std::size_t triangles_ = 0, count_ = 0, tested_ = 0, visible_ = 0;  // tested_: rows; visible_: cells of these
  std::array<GridEdges, kTriangles> edges_;
  std::array<ClosingRow, kRows + 1> rows_;
  std::array<Origin, kRows + 1> origins_;
  std::array<GridCell, kCells> cells_;  // those that are partial
  std::array<std::uint32_t, kCells + 1> masks_;
};

DepthBounds<float> sample_bounds(const SetupTriangle& triangle) {
  return sample_bounds(vertex_bounds(triangle.vertex_z), triangle.depth.dzdx, triangle.depth.dzdy);
}

}  // namespace

void sample_raster(const SampledTriangles& in, const TriangleList& list, StageCounters& counters,
                   std::vector<SampleFragment>& out, ClosedDepth* closed) {
  const std::size_t before = out.size();
  Traversal traversal{in.tile, in.sampling.grid, FullMeans::samples};
  SampleRasterWork work;
  CellBlock block(in, closed, out, work);
  constexpr std::size_t kAhead = 6;  // triangles
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (i + kAhead < list.size()) prefetch(in.triangles.triangles[list[i + kAhead]]);
    const std::uint32_t index = list[i];
    const SetupTriangle& triangle = in.triangles.triangles[index];
    const DepthBounds<float> depths = sample_bounds(triangle);
    if (closed && closed->hides_everywhere(depths.nearest)) continue;
    const EdgeSet set(triangle);
    block.start(index, set, depths, in.triangles.is_opaque(index));
    traverse_quads(triangle, set, traversal,
                   [&](std::int32_t x, std::int32_t y, const QuadRow& cells) { block.add(x, y, cells); });
    block.hide();
    if (closed) closed->refresh();
  }
  block.finish();

  work.traversal = traversal.counts;
  work.fragments = out.size() - before;
  charge(work, in.sampling.pattern, counters);
  if (closed) {
    charge_bounds(list.size(), counters);
    charge(*closed, counters);
  }
}

}  // namespace beampipe
