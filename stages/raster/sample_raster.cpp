#include "stages/raster/sample_raster.h"

#include <algorithm>
#include <array>
#include <bit>

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

// The fragments of some triangles, before the samples of their partial cells are tested: in blocks, which stay in the
// nearest cache.
class FragmentBlock {
 public:
  FragmentBlock(const SampledTriangles& in, ClosedDepth* closed, std::vector<SampleFragment>& out,
                SampleRasterWork& work)
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

  // As traverse_quads() visits them. Nothing branches on what is full or hidden, which no processor predicts.
  void add(std::int32_t left, std::int32_t top, const QuadRow& cells) {
    if (count_ + 4 * kQuadsPerRow > kFragments) finish();
    const std::uint32_t edges = static_cast<std::uint32_t>(triangles_ - 1);
    std::size_t count = count_, partial = partial_, tests = 0;
    for (std::uint64_t bits = cells.touched; bits != 0; bits &= bits - 1, ++tests) {
      const int bit = std::countr_zero(bits);
      const std::int32_t x = left + column_of(bit), y = top + row_of(bit);
      const bool full = (cells.full >> bit & 1) != 0;
      const bool hidden =
          closed_ && closed_->hides_or_closes(x, y, depths_.nearest, depths_.farthest, full & is_opaque_);
      fragments_[count] = {triangle_, quad_ + static_cast<std::uint32_t>(bit >> 2), x, y, every_sample_};
      cells_[partial] = {edges, x, y};
      fragment_[partial] = static_cast<std::uint32_t>(count);
      partial += !full & !hidden;
      count += !hidden;
    }
    quad_ += kQuadsPerRow;
    const std::size_t visible = count - count_, full = visible - (partial - partial_);
    count_ = count, partial_ = partial;
    if (closed_) closed_->count(tests, tests - visible, is_opaque_ ? full : 0);
  }

  // Tests the samples of the partial cells, and hands on the fragments that have any.
  void finish() {
    std::array<std::uint32_t, kFragments> masks;
    work_.covered_samples += sample_masks(edges_.data(), cells_.data(), partial_, sampling_.pattern, masks.data());
    work_.partial_cells += partial_;
    for (std::size_t i = 0; i < partial_; ++i) fragments_[fragment_[i]].mask = masks[i];
    std::size_t left = 0;
    for (std::size_t i = 0; i < count_; ++i) {
      const bool has_samples = fragments_[i].mask != 0;  // asked before the copy, which would have to be waited for
      fragments_[left] = fragments_[i];
      left += has_samples;
    }
    out_.insert(out_.end(), fragments_.begin(), fragments_.begin() + static_cast<std::ptrdiff_t>(left));
    if (triangles_ > 0) edges_[0] = edges_[triangles_ - 1];  // its cells may go on
    count_ = partial_ = 0;
    triangles_ = std::min<std::size_t>(triangles_, 1);
  }

 private:
  static constexpr std::size_t kTriangles = 64, kFragments = 256;

  const Sampling& sampling_;
  std::uint32_t every_sample_;
  ClosedDepth* closed_;
  std::vector<SampleFragment>& out_;
  SampleRasterWork& work_;

  std::uint32_t triangle_ = 0, quad_ = 0;
  DepthBounds<float> depths_{};
  bool is_opaque_ = false;
  std::size_t triangles_ = 0, count_ = 0, partial_ = 0;
  std::array<GridEdges, kTriangles> edges_;
  std::array<SampleFragment, kFragments> fragments_;
  std::array<GridCell, kFragments> cells_;          // those that are partial
  std::array<std::uint32_t, kFragments> fragment_;  // of each of them: its number in the block
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
  FragmentBlock block(in, closed, out, work);
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
