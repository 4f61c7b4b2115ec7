#include "stages/raster/sample_raster.h"

#include <array>

#include "simd/population_count.h"
#include "simd/sample_mask.h"
#include "stages/data/pixel_depth.h"
#include "stages/raster/sample_raster_cost.h"
#include "stages/raster/traverse.h"

namespace beampipe {
namespace {

// `x`, `y`: the cell's upper left corner in 1/256 px.
CellEdges cell_edges(const EdgeSet& set, std::int64_t x, std::int64_t y) {
  CellEdges cell;
  for (std::size_t k = 0; k < 3; ++k) {
    const Edge& edge = set.edges[k];
    cell.a[k] = edge.a, cell.b[k] = edge.b;
    cell.c[k] = edge.at(x, y) - (edge.owns ? 0 : 1);
  }
  return cell;
}

// Cells that need the sample test. Blocks of them are tested at once, while they are in the nearest cache.
class PartialCells {
 public:
  PartialCells(const SamplePattern& pattern, std::vector<SampleFragment>& fragments, SampleRasterWork& work)
      : pattern_(pattern), fragments_(fragments), work_(work) {}

  // The cell of the next fragment.
  void add(const CellEdges& cell) {
    if (count_ == kBlock) test();
    cells_[count_] = cell;
    fragment_[count_++] = fragments_.size();
  }

  // Sets the masks of the fragments whose cells were added.
  void test() {
    std::array<std::uint32_t, kBlock> masks;
    sample_masks(cells_.data(), count_, pattern_, masks.data());
    for (std::size_t i = 0; i < count_; ++i) {
      fragments_[fragment_[i]].mask = masks[i];
      work_.covered_samples += population_count(masks[i]);
    }
    work_.partial_cells += count_;
    count_ = 0;
  }

 private:
  static constexpr std::size_t kBlock = 256;

  const SamplePattern& pattern_;
  std::vector<SampleFragment>& fragments_;
  SampleRasterWork& work_;
  std::size_t count_ = 0;
  std::array<CellEdges, kBlock> cells_;
  std::array<std::size_t, kBlock> fragment_;
};

DepthBounds<float> sample_bounds(const SetupTriangle& triangle) {
  return sample_bounds(vertex_bounds(triangle.vertex_z), triangle.depth.dzdx, triangle.depth.dzdy);
}

}  // namespace

void sample_raster(const SampledTriangles& in, const TriangleList& list, StageCounters& counters,
                   std::vector<SampleFragment>& out, ClosedDepth* closed) {
  const Sampling& sampling = in.sampling;
  const std::uint32_t every_sample = ~0u >> (kMaxMaskSamples - sampling.pattern.count);
  const std::size_t before = out.size();
  Traversal traversal{in.tile, sampling.grid, FullMeans::samples};
  SampleRasterWork work;
  PartialCells partial(sampling.pattern, out, work);
  for (const std::uint32_t index : list) {
    const SetupTriangle& triangle = in.triangles.triangles[index];
    const DepthBounds<float> depths = sample_bounds(triangle);
    if (closed && closed->hides_everywhere(depths.nearest)) continue;
    const EdgeSet set(triangle);
    traverse(triangle, set, traversal, [&](std::int32_t x, std::int32_t y, std::uint32_t q, bool full) {
      if (closed && closed->hides(x, y, depths.nearest)) return;
      if (closed && full && in.triangles.is_opaque(index)) closed->close(x, y, depths.farthest);
      if (!full) {
        partial.add(cell_edges(set, std::int64_t{x} * sampling.grid.cell_width(),
                               std::int64_t{y} * sampling.grid.cell_height()));
      }
      out.push_back({index, q, x, y, every_sample});
    });
    if (closed) closed->refresh();
  }
  partial.test();
  const auto start = out.begin() + static_cast<std::ptrdiff_t>(before);
  out.erase(std::remove_if(start, out.end(), [](const SampleFragment& f) { return f.mask == 0; }), out.end());

  work.traversal = traversal.counts;
  work.fragments = out.size() - before;
  charge(work, sampling.pattern, counters);
  if (closed) {
    charge_bounds(list.size(), counters);
    charge(*closed, counters);
  }
}

}  // namespace beampipe
