// The costs of the rules that all composers of surfaces share: each rule is run once on numbers that count.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "stages/beam/owner_rules.h"
#include "stages/beam/specks_cost.h"
#include "stages/cost/counted_mask.h"
#include "stages/cost/plane_cost.h"
#include "stages/data/pooled_pixels.h"
#include "stages/data/position_set.h"

namespace beampipe {

// To take a pixel's positions apart by bit planes, and to put together those of so many states.
inline OperationCounts split_cost(std::size_t planes, std::size_t words) {
  return count_operations([&](OperationCounts& counts) {
    const CountedMask mask{words, &counts};
    std::array<CountedMask, kMostStates> states;
    split_states(
        planes, mask, [&](std::size_t) { return mask; }, states.data());
  });
}
inline OperationCounts join_cost(std::size_t states, std::size_t words) {
  return count_operations([&](OperationCounts& counts) {
    std::array<CountedMask, kMostStates> masks;
    masks.fill({words, &counts});
    for (std::size_t p = 0; p < planes_for(states); ++p) join_states(p, states, masks[0], masks.data());
  });
}

// Per contest: the difference of two planes, and its sign in the whole pixel.
inline OperationCounts plane_gap_cost() {
  return count_operations([](OperationCounts& counts) {
    const Counted<float> one(1.0f, counts);
    const DepthPlane<Counted<float>> plane{one, one, one};
    const PlaneGap<Counted<float>> gap = plane_gap(plane, plane);
    static_cast<void>(is_nearer(gap));
    static_cast<void>(is_farther(gap));
  });
}

// Per test whether an owner is final: the bounds of its plane in the pixel, both of which are compared.
inline OperationCounts finality_cost() {
  return count_operations([](OperationCounts& counts) {
    const Counted<float> one(1.0f, counts);
    finality_of(DepthPlane<Counted<float>>{one, one, one}, one);
  });
}

// Per position, to find the farthest depth of a plane.
inline OperationCounts farthest_cost() {
  return count_operations([](OperationCounts& counts) {
    const Counted<float> one(1.0f, counts);
    farthest_formula(DepthPlane<Counted<float>>{one, one, one}, one, one, true, one);
  });
}

// Per pair of owners that may be merged.
inline OperationCounts pair_cost() {
  return count_operations([](OperationCounts& counts) {
    const Counted<float> one(1.0f, counts);
    const PlacedSurface<Counted<float>> surface{one, {one, one, one}, one, one};
    static_cast<void>(merge_loss(surface, surface) < one);
  });
}

// Per speck: the three positions next to it are looked up, and then their states, a bit in each plane; and the sum of
// their votes.
inline OperationCounts speck_votes_cost(std::size_t planes) {
  return count_operations([&](OperationCounts& counts) {
    const Counted<float> one(1.0f, counts);
    for (int axis = 0; axis < 2; ++axis) PositionSet::place_of(one);
    counts.fetch += 1 + 3;
    const Counted<std::uint32_t> word(0, counts);
    Counted<float> votes(0.0f);
    for (int position = 0; position < 3; ++position) {
      for (std::size_t p = 0; p < planes; ++p) word >> 0 & word;
      votes = votes + one;
    }
  });
}

// Per pixel whose two estimates are compared, with the conversion of its sums.
inline OperationCounts limit_cost() {
  return count_operations([](OperationCounts& counts) {
    using Number = Counted<float>;
    const Number one(1.0f, counts);
    const auto sum = [&] { return to_float(Counted<std::int32_t>(0, counts)) * one; };
    const Estimate<Number> analytic{sum(), {sum(), sum(), sum()}}, counted{one * one, {sum(), sum(), sum()}};
    limited_estimate(analytic, counted, one);
  });
}

}  // namespace beampipe
