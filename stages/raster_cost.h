// What the raster stages charge: operations per tested cell, and the bytes of what they pass on.
#pragma once

#include "stages/counting.h"

namespace beampipe {

// A (pixel, triangle) pair on its way to the fragment stage: 16-bit x and y, 32-bit triangle; `full` takes a spare bit.
inline constexpr std::uint32_t kPixelTriangleBytes = 8;

// A sample fragment adds its 16-bit coverage mask.
inline constexpr std::uint64_t kSampleFragmentBytes = kPixelTriangleBytes + 2;

// Three edge values at the cell's corner by stepping, each compared at its deepest and its shallowest corner.
inline OperationCounts cell_test_cost() {
  return count_operations([](OperationCounts& counts) {
    using Int = Counted<std::int64_t>;
    const Int zero(0);
    bool touched = true, full = true;
    for (int k = 0; k < 3; ++k) {
      const Int corner(0, counts), step(0, counts), deepest(0, counts), shallowest(0, counts);
      const Int value = corner + step;
      touched &= value + deepest >= zero;
      full &= value + shallowest >= zero;
    }
    static_cast<void>(touched && full);
  });
}

}  // namespace beampipe
