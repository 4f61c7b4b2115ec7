// The scalar twin of the raster stages: it visits the cells of a triangle's bounding box one after the other and steps
// the edge values from cell to cell and from row to row.

#include "simd/sample_mask.h"
#include "stages/raster/conservative_raster.h"
#include "stages/raster/sample_raster.h"
#include "stages/raster/traverse.h"
#include "tests/stages/scene_twins.h"

namespace beampipe::raster_twins_test {

using namespace twins;

struct Cell {
  std::uint32_t triangle;
  std::int32_t x, y;
  std::uint32_t samples;  // 1 for a touched cell, or its mask

  auto operator<=>(const Cell&) const = default;
};

class RasterTwins : public SceneTwins {
 protected:
  // Calls visit(x, y, corner, full) for the cells that the triangle touches; corner[k]: edge k's value at the cell's
  // upper left corner.
  template <class Visit>
  void each_touched_cell(const SetupTriangle& triangle, const CellGrid& grid, FullMeans meaning, Visit&& visit) {
    const auto [left, right] = cells(triangle.x, grid.cell_width(), tile_.x0 * grid.columns, tile_.x1 * grid.columns);
    const auto [top, bottom] = cells(triangle.y, grid.cell_height(), tile_.y0 * grid.rows, tile_.y1 * grid.rows);
    if (left.value >= right.value || top.value >= bottom.value) return;
    const Int zero(0), x = left * integer(grid.cell_width()), y = top * integer(grid.cell_height());
    struct Stepped {
      Int row, to_right, down, deepest, shallowest;
    };
    std::array<Stepped, 3> edges;
    for (int k = 0; k < 3; ++k) {
      const Edge edge = edge_of(triangle, k);
      const int next = (k + 1) % 3;
      const Int from_x = integer(triangle.x[k]), from_y = integer(triangle.y[k]);
      const Int a = from_y - integer(triangle.y[next]), b = integer(triangle.x[next]) - from_x;
      const Int c = zero - (a * from_x + b * from_y);
      Stepped& e = edges[static_cast<std::size_t>(k)];
      e = {a * x + b * y + c, a * integer(grid.cell_width()), b * integer(grid.cell_height()), {}, {}};
      e.deepest = greater(e.to_right, zero) + greater(e.down, zero);
      e.shallowest = lesser(e.to_right, zero) + lesser(e.down, zero);
      if (meaning == FullMeans::samples) e.shallowest = e.shallowest - integer(edge.owns ? 0 : 1);
    }
    for (auto row = top.value; row < bottom.value; ++row) {
      std::array<Int, 3> corner;
      for (std::size_t k = 0; k < 3; ++k) {
        if (row > top.value) edges[k].row = edges[k].row + edges[k].down;
        corner[k] = edges[k].row;
      }
      for (auto column = left.value; column < right.value; ++column) {
        ++cells_;
        bool touched = true, full = true;
        for (std::size_t k = 0; k < 3; ++k) {
          if (column > left.value) corner[k] = corner[k] + edges[k].to_right;
          touched &= corner[k] + edges[k].deepest >= zero;
          full &= corner[k] + edges[k].shallowest >= zero;
        }
        if (touched) visit(static_cast<std::int32_t>(column), static_cast<std::int32_t>(row), corner, full);
      }
    }
  }

  std::uint64_t cells_ = 0;  // that were tested

 private:
  // The cells within [first, end), each `size` units wide, that the closed interval of three coordinates touches.
  std::pair<Int, Int> cells(const std::int32_t at[3], int size, int first, int end) {
    const Int a = integer(at[0]), b = integer(at[1]), c = integer(at[2]), one(1);
    const int places = std::countr_zero(static_cast<unsigned>(size));
    return {greater((lesser(lesser(a, b), c) - one) >> places, integer(first)),
            lesser((greater(greater(a, b), c) >> places) + one, integer(end))};
  }
};

TEST_P(RasterTwins, ConservativeRaster) {
  StageCounters counters;
  std::vector<Pair> pairs;
  conservative_raster(triangles_, list_, tile_, counters, pairs, {.depths = PairDepths::none});
  std::vector<Cell> found, expected;
  for (const Pair& pair : pairs) found.push_back({pair.triangle, pair.x, pair.y, pair.full ? 1u : 0u});
  for (const std::uint32_t index : list_)
    each_touched_cell(triangles_.triangles[index], CellGrid{}, FullMeans::area,
                      [&](std::int32_t x, std::int32_t y, const std::array<Int, 3>&, bool full) {
                        expected.push_back({index, x, y, full ? 1u : 0u});
                      });
  std::sort(found.begin(), found.end());
  std::sort(expected.begin(), expected.end());
  EXPECT_EQ(found, expected);
  EXPECT_EQ(counters.ops, twin_);
  EXPECT_EQ(counters.lanes_used, expected.size());
  EXPECT_EQ(counters.lanes_issued, cells_);
}

TEST_P(RasterTwins, SampleRaster) {
  for (const Sampling& sampling :
       {Sampling{CellGrid{}, standard_pattern(8)}, Sampling{CellGrid{2, 2}, standard_pattern(4)}}) {
    StageCounters counters;
    std::vector<SampleFragment> fragments;
    sample_raster({triangles_, tile_, sampling}, list_, counters, fragments);
    std::vector<Cell> found, expected;
    for (const SampleFragment& fragment : fragments)
      found.push_back({fragment.triangle, fragment.x, fragment.y, fragment.mask});
    twin_ = {};
    std::uint64_t tested = 0, covered = 0;
    for (const std::uint32_t index : list_) {
      const SetupTriangle& triangle = triangles_.triangles[index];
      each_touched_cell(triangle, sampling.grid, FullMeans::samples,
                        [&](std::int32_t x, std::int32_t y, const std::array<Int, 3>& corner, bool full) {
                          std::uint32_t mask = (1u << sampling.pattern.count) - 1;
                          if (!full) {
                            Int a[3], b[3], c[3];
                            for (int k = 0; k < 3; ++k) {
                              const Edge edge = edge_of(triangle, k);
                              a[k] = integer(edge.a), b[k] = integer(edge.b);
                              c[k] = corner[static_cast<std::size_t>(k)] - integer(edge.owns ? 0 : 1);
                            }
                            mask = sample_mask_scalar(a, b, c, sampling.pattern);
                            ++tested, covered += static_cast<std::uint64_t>(std::popcount(mask));
                          }
                          if (mask != 0) expected.push_back({index, x, y, mask});
                        });
    }
    std::sort(found.begin(), found.end());
    std::sort(expected.begin(), expected.end());
    EXPECT_EQ(found, expected);
    EXPECT_EQ(counters.ops, twin_);
    EXPECT_EQ(counters.lanes_used, covered);
    EXPECT_EQ(counters.lanes_issued, tested * static_cast<std::uint64_t>(sampling.pattern.count));
  }
}

BEAMPIPE_ON_EVERY_SCENE(RasterTwins);

}  // namespace beampipe::raster_twins_test
