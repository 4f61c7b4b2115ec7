#include "stages/raster/sample_raster.h"

#include <algorithm>
#include <array>
#include <bit>

#include "simd/population_count.h"
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

  // The cells that are added next belong to this triangle.
  void start(std::uint32_t triangle, const EdgeSet& set, const DepthBounds<float>& depths, bool is_opaque) {
    if (triangles_ == kTriangles) finish();
    edges_[triangles_++] = grid_edges(set, sampling_.grid);
    triangle_ = triangle, depths_ = depths, is_opaque_ = is_opaque;
  }

  // As traverse_quads() visits them.
  void add(std::int32_t x, std::int32_t y, const QuadRow& cells) {
    const std::uint32_t quad = quad_;
    quad_ += kQuadsPerRow;
    if (cells.touched == 0) return;
    std::uint64_t visible = cells.touched;
    if (closed_) visible &= ~closed_->hides_or_closes(x, y, cells, depths_.nearest, depths_.farthest, is_opaque_);
    if (visible == 0) return;
    if (rows_in_block_ == kRows || partial_ + 4 * kQuadsPerRow > kCells) finish();
    rows_[rows_in_block_++] = {triangle_, quad, x, y, visible, cells.full};
    const auto edges = static_cast<std::uint32_t>(triangles_ - 1);
    for (std::uint64_t bits = visible & ~cells.full; bits != 0; bits &= bits - 1) {
      const int bit = std::countr_zero(bits);
      cells_[partial_++] = {edges, x + column_of(bit), y + row_of(bit)};
    }
    visible_ += population_count(static_cast<std::uint32_t>(visible)) +
                population_count(static_cast<std::uint32_t>(visible >> 32));
  }

  // Tests the samples of the partial cells, and hands on the fragments that have any.
  void finish() {
    work_.covered_samples += sample_masks(edges_.data(), cells_.data(), partial_, sampling_.pattern, masks_.data());
    work_.partial_cells += partial_;
    const std::size_t before = out_.size();
    out_.resize(before + visible_ + 1);
    SampleFragment* fragment = out_.data() + before;
    const std::uint32_t* mask = masks_.data();
    for (std::size_t i = 0; i < rows_in_block_; ++i) {
      const Row& row = rows_[i];
      for (std::uint64_t bits = row.visible; bits != 0; bits &= bits - 1) {
        const int bit = std::countr_zero(bits);
        const bool full = (row.full >> bit & 1) != 0;
        const std::uint32_t samples = full ? every_sample_ : *mask;
        *fragment = {row.triangle, row.quad + static_cast<std::uint32_t>(bit >> 2), row.x + column_of(bit),
                     row.y + row_of(bit), samples};
        mask += !full;
        fragment += samples != 0;
      }
    }
    out_.resize(static_cast<std::size_t>(fragment - out_.data()));
    if (triangles_ > 0) edges_[0] = edges_[triangles_ - 1];  // its cells may go on
    rows_in_block_ = partial_ = visible_ = 0;
    triangles_ = std::min<std::size_t>(triangles_, 1);
  }

 private:
  static constexpr std::size_t kTriangles = 64, kRows = 64, kCells = 256;

  // A row of quads.
  struct Row {
    std::uint32_t triangle, quad;
    std::int32_t x, y;
    std::uint64_t visible, full;
  };

  const Sampling& sampling_;
  std::uint32_t every_sample_;
  ClosedDepth* closed_;
  std::vector<SampleFragment>& out_;
  SampleRasterWork& work_;

  std::uint32_t triangle_ = 0, quad_ = 0;
  DepthBounds<float> depths_{};
  bool is_opaque_ = false;
  std::size_t triangles_ = 0, rows_in_block_ = 0, partial_ = 0, visible_ = 0;
  std::array<GridEdges, kTriangles> edges_;
  std::array<Row, kRows> rows_;
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
  for (const std::uint32_t index : list) {
    const SetupTriangle& triangle = in.triangles.triangles[index];
    const DepthBounds<float> depths = sample_bounds(triangle);
    if (closed && closed->hides_everywhere(depths.nearest)) continue;
    const EdgeSet set(triangle);
    block.start(index, set, depths, in.triangles.is_opaque(index));
    traverse_quads(triangle, set, traversal,
                   [&](std::int32_t x, std::int32_t y, const QuadRow& cells) { block.add(x, y, cells); });
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
