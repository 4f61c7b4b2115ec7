// What the traversal of cells costs.
#pragma once

#include "stages/cost/counting.h"
#include "stages/raster/traverse.h"

namespace beampipe {

// The range of cells that a triangle's bounding box touches within the tile.
inline OperationCounts box_cost() {
  return count_operations([](OperationCounts& counts) {
    using Int = Counted<std::int64_t>;
    const Int x(0, counts), one(1);
    for (int axis = 0; axis < 2; ++axis) {
      const Int low = lesser(lesser(x, x), x), high = greater(greater(x, x), x);
      greater((low - one) >> 1, x), lesser((high >> 1) + one, x);
    }
  });
}

// Per triangle, to set up its first cell: the cell's corner and, per edge, a, b and c, the value at the corner, the
// steps to the right and down, and what to add for the cell's deepest and shallowest corners.
inline OperationCounts start_cost(FullMeans meaning) {
  return count_operations([&](OperationCounts& counts) {
    using Int = Counted<std::int64_t>;
    const Int one(1, counts), zero(0);
    const Int x = one * one, y = one * one;
    for (int k = 0; k < 3; ++k) {
      const Int a = one - one, b = one - one;
      static_cast<void>(zero - (a * one + b * one));  // c
      const Int right = one * one, down = one * one;
      greater(right, zero) + greater(down, zero);
      const Int shallowest = lesser(right, zero) + lesser(down, zero);
      if (meaning == FullMeans::samples) shallowest - one;
      one* x + one* y + one;
    }
  });
}

// One step to the next cell, to the right or in the row below: an addition per edge.
inline OperationCounts step_cost() { return {.add = 3}; }

// Every edge at the cell's deepest and shallowest corners.
inline OperationCounts cell_test_cost() {
  return count_operations([](OperationCounts& counts) {
    const Counted<double> value(0.0, counts);
    bool touched = true, full = true;
    for (int k = 0; k < 3; ++k) cell_against_edge(value, value, value, touched, full);
  });
}

inline OperationCounts traversal_cost(const TraversalCounts& counts, FullMeans meaning) {
  static const UnitCost of_box = box_cost(), of_area_start = start_cost(FullMeans::area),
                        of_sample_start = start_cost(FullMeans::samples), of_cell = cell_test_cost();
  OperationCounts cost = of_box * counts.boxes;
  cost += (meaning == FullMeans::area ? of_area_start : of_sample_start) * counts.traversals;
  cost += step_cost() * (counts.cells_tested - counts.traversals);
  cost += of_cell * counts.cells_tested;
  return cost;
}

}  // namespace beampipe
