// What finding shading points is charged.
#pragma once

#include <vector>

#include "stages/cost/counting.h"
#include "stages/samples/sample_formulas.h"

namespace beampipe {

// Does the triangle cover the cell's centre?
inline OperationCounts centre_cost() {
  return count_operations([](OperationCounts& counts) {
    const Counted<std::int64_t> one(1, counts);
    for (int k = 0; k < 3; ++k) is_inside(EdgeAt<Counted<std::int64_t>>{one, one, one}, one, one, one);
  });
}

inline OperationCounts centroid_cost(int samples) {
  return count_operations([&](OperationCounts& counts) {
    std::vector<Counted<std::uint32_t>> bits(static_cast<std::size_t>(samples));
    std::vector<Counted<float>> x(bits.size(), Counted<float>(1.0f, counts));
    mean_position(Counted<std::uint32_t>(1, counts), bits.data(), x.data(), x.data(), samples);
  });
}

// `moved`: fragments that are shaded at their centroid. `samples`: per cell.
inline void charge_shading_points(std::uint64_t fragments, std::uint64_t moved, int samples, StageCounters& counters) {
  counters.ops += centre_cost() * fragments;
  counters.ops += centroid_cost(samples) * moved;
}

}  // namespace beampipe
