// The cost of formulas that several stages share: depth planes, depth bounds, and masks with the states of
// their positions.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "simd/depth_compare.h"
#include "simd/plane_order.h"
#include "stages/cost/counting.h"
#include "stages/data/pixel_depth.h"
#include "stages/data/position_states.h"

namespace beampipe {

// To compare two planes at one position.
inline OperationCounts nearer_cost() {
  return count_operations([](OperationCounts& counts) {
    const Counted<float> one(1.0f, counts);
    const DepthPlane<Counted<float>> plane{one, one, one};
    nearer_formula(plane, plane, one, one);
  });
}

// To test a plane at one place against the depth that is stored there.
inline OperationCounts depth_test_cost() {
  return count_operations([](OperationCounts& counts) {
    const Counted<float> one(1.0f, counts);
    Counted<float> depth;
    depth_test_scalar({one, one, one}, one, one, one, depth);
  });
}

// To make a triangle's plane in a pixel.
inline OperationCounts plane_cost() {
  return count_operations([](OperationCounts& counts) {
    const Counted<double> one(1.0, counts);
    to_float(ScreenDepthOf<Counted<double>>{one, one, one, one, one}.at(one, one)), to_float(one), to_float(one);
  });
}

// To make its plane in a cell.
inline OperationCounts cell_plane_cost() {
  return count_operations([](OperationCounts& counts) {
    const Counted<double> one(1.0, counts);
    cell_plane<Counted<double>>({one, one, one, one, one}, one, one);
  });
}

inline OperationCounts vertex_bounds_cost() {
  return count_operations([](OperationCounts& counts) {
    const Counted<float> z[3] = {Counted<float>(0, counts), Counted<float>(0, counts), Counted<float>(0, counts)};
    vertex_bounds(z);
  });
}

// The depth bounds of a pair whose plane is known.
inline OperationCounts plane_bounds_cost() {
  return count_operations([](OperationCounts& counts) {
    const Counted<float> z(0.0f, counts);
    pair_bounds<Counted<float>>({z, z, z}, {z, z});
  });
}

// The depth bounds of a pair, including its plane.
inline OperationCounts pair_bounds_cost() {
  OperationCounts cost = plane_cost();
  cost += plane_bounds_cost();
  return cost;
}

// The depth bounds of a triangle's samples, including those of its vertices.
inline OperationCounts sample_bounds_cost() {
  return count_operations([](OperationCounts& counts) {
    const Counted<float> z[3] = {Counted<float>(0, counts), Counted<float>(0, counts), Counted<float>(0, counts)};
    const Counted<double> slope(0.0, counts);
    sample_bounds(vertex_bounds(z), slope, slope);
  });
}

// The population counts of a mask's words, and their sum.
inline OperationCounts count_cost(std::size_t words) {
  return count_operations([&](OperationCounts& counts) {
    Counted<float> sum = bit_count(Counted<std::uint32_t>(0, counts));
    for (std::size_t w = 1; w < words; ++w) sum = sum + bit_count(Counted<std::uint32_t>(0, counts));
  });
}

// Per word of 32 positions whose states have `Bits` bits: to find the positions that are in `state`, and to put
// positions into it.
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
