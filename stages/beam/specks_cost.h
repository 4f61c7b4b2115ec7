// The costs of rules on specks.
#pragma once

#include "stages/beam/specks.h"
#include "stages/cost/counting.h"

namespace beampipe {

// Per comparison of a speck with a surface; its place is made relative to the pixel's centre.
inline OperationCounts speck_test_cost() {
  return count_operations([](OperationCounts& counts) {
    const Counted<float> one(1.0f, counts), half(0.5f);
    is_on_or_before(one, DepthPlane<Counted<float>>{one, one, one}, one - half, one - half);
  });
}

}  // namespace beampipe
