// What comparing two depth planes at one position is charged with.
#pragma once

#include "simd/plane_order.h"
#include "stages/counting.h"

namespace beampipe {

inline OperationCounts nearer_cost() {
  return count_operations([](OperationCounts& counts) {
    const Counted<float> one(1.0f, counts);
    const DepthPlane<Counted<float>> plane{one, one, one};
    nearer_scalar(plane, plane, one, one);
  });
}

}  // namespace beampipe
