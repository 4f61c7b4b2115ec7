// What depth planes and the states of mask positions are charged with.
#pragma once

#include <bit>

#include "simd/plane_order.h"
#include "stages/beam/fragment_geometry.h"
#include "stages/cost/counting.h"
#include "stages/data/position_states.h"

namespace beampipe {

inline OperationCounts nearer_cost() {
  return count_operations([](OperationCounts& counts) {
    const Counted<float> one(1.0f, counts);
    const DepthPlane<Counted<float>> plane{one, one, one};
    nearer_formula(plane, plane, one, one);
  });
}

// Making a triangle's plane over a pixel.
inline OperationCounts plane_cost() {
  return count_operations([](OperationCounts& counts) {
    const Counted<double> one(1.0, counts);
    to_float(plane_at(one, one, one, one, one, one, one)), to_float(one), to_float(one);
  });
}

// Of a word of 32 positions with so many bits of state: finding those in `state`, and putting some into it.
template <std::size_t Bits>
OperationCounts find_cost(std::uint32_t state) {
  return count_operations([&](OperationCounts& counts) {
    std::array<Counted<std::uint32_t>, Bits> planes;
    planes.fill(Counted<std::uint32_t>(0, counts));
    word_in_state(planes, state);
  });
}
template <std::size_t Bits>
OperationCounts put_cost(std::uint32_t state) {
  return count_operations([&](OperationCounts& counts) {
    const Counted<std::uint32_t> word(0, counts);
    for (std::size_t b = 0; b < Bits; ++b) word_put(word, word, state >> b & 1);
  });
}

}  // namespace beampipe
