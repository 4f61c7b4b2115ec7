// What it costs to compare the depths of samples.
#pragma once

#include "simd/depth_compare.h"
#include "stages/cost/counting.h"
#include "stages/data/pixel_depth.h"

namespace beampipe {

// Of either test, per sample.
inline OperationCounts sample_depth_cost() {
  return count_operations([](OperationCounts& counts) {
    const Counted<float> one(1.0f, counts);
    Counted<float> depth;
    depth_test_scalar({one, one, one}, one, one, one, depth);
  });
}

// Per fragment: its depth plane in the cell.
inline OperationCounts cell_plane_cost() {
  return count_operations([](OperationCounts& counts) {
    const Counted<double> one(1.0, counts);
    cell_plane<Counted<double>>({one, one, one, one, one}, one, one);
  });
}

}  // namespace beampipe
