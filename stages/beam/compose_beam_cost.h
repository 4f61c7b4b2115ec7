// What composing windows is charged with: its scalar twins on counting numbers.
#pragma once

#include "simd/conserve.h"
#include "simd/window_owners.h"
#include "stages/cost/counting.h"
#include "stages/data/position_set.h"

namespace beampipe {

// A speck of a smooth surface counts as part of the surface that owns the position beside it when it lies at most this
// far behind, in pixels of that surface's slope: a quarter of the distance between positions of a 256-bit mask.
inline constexpr float kSurfaceReach = 1.0f / 64.0f;

// Specks whose nearest position is the same have at most so many times that position's share of the pixel together;
// more is several surfaces on top of each other. Twice is about the most that lies nearest to one position; four times
// leaves dense meshes alone.
inline constexpr float kSpeckShares = 4.0f;

using CountedFloat = Counted<float>;
using CountedBits = Counted<std::uint32_t>;

// A fragment's masks, word by word: what is open of it, what others want too; how many positions it covers and has.
inline OperationCounts mask_cost(std::size_t words) {
  return count_operations([&](OperationCounts& counts) {
    const CountedBits mask(~0u, counts);
    CountedFloat covered(0.0f), visible(0.0f);
    for (std::size_t i = 0; i < words; ++i) {
      const CountedBits open = mask & ~mask;
      mask | (mask & open);  // wanted twice
      mask | open;           // wanted once
      mask | open;           // taken
      covered = covered + bit_count(mask);
      visible = visible + bit_count(open);
    }
    static_cast<void>(visible == covered);  // is it whole?
  });
}

// A fragment of a window with contested positions: its depth at the pixel's corner, slopes per 1/256 px, and its mask
// without what it has lost.
inline OperationCounts contest_cost(std::size_t words) {
  return count_operations([&](OperationCounts& counts) {
    const CountedFloat one(1.0f, counts);
    one - CountedFloat(0.5f) * one - CountedFloat(0.5f) * one;
    for (int axis = 0; axis < 2; ++axis) one / CountedFloat(kSubpixelUnits);
    const CountedBits mask(~0u, counts);
    for (std::size_t i = 0; i < words; ++i) mask&(~mask | mask);
  });
}

// Area and colour of a fragment, times the part that is seen, on top of what is there.
inline void add_color(const CountedFloat& area, const CountedFloat& one) {
  const CountedFloat share = area / one;
  one + area;
  for (int channel = 0; channel < 3; ++channel) one + share* one;
}

inline OperationCounts addition_cost() {
  return count_operations([](OperationCounts& counts) {
    const CountedFloat one(1.0f, counts);
    const CountedFloat area = visible_area(one, one, one, one, Taken<CountedFloat>{one, one});
    one + one;  // positions
    add_color(area, one);
  });
}

// A fragment that covers no position: the three that are nearest, asked for who owns them; the two sides' areas there.
inline OperationCounts speck_cost() {
  return count_operations([](OperationCounts& counts) {
    const CountedFloat one(1.0f, counts), limit(kSpeckShares);
    for (int axis = 0; axis < 2; ++axis) lesser(greater(converted(one * CountedFloat(PositionSet::kPlaces)), one), one);
    CountedFloat votes(0.0f);
    for (int vote = 0; vote < 3; ++vote) votes = votes + one;
    counts.fetch += 1 + 3;                  // the positions, their owners
    counts.bit += 3;                        // are they taken?
    one + one* votes / CountedFloat(3.0f);  // of the side that it faces
    const CountedFloat larger = greater(one, one);
    const bool is_front = one >= one;
    static_cast<void>(is_front);
    const CountedFloat area = one * lesser(limit / (one * larger), one);
    add_color(lesser(area, CountedFloat(1.0f) - one), one);
  });
}

// Is a speck before a surface, or on it?
inline OperationCounts surface_cost() {
  return count_operations([](OperationCounts& counts) {
    const CountedFloat one(1.0f, counts), half(0.5f);
    const DepthPlane<CountedFloat> plane{one, one, one};
    const CountedFloat reach = CountedFloat(kSurfaceReach) * (magnitude(plane.dzdu) + magnitude(plane.dzdv));
    static_cast<void>(one <= depth_at(plane, one - half, one - half) + reach);
  });
}

inline OperationCounts closing_cost() {
  return count_operations([](OperationCounts& counts) {
    const CountedFloat one(1.0f, counts), scale = one / one;
    for (int channel = 0; channel < 3; ++channel) one* scale;
  });
}

inline OperationCounts depth_compare_cost() {
  return count_operations([](OperationCounts& counts) {
    const Counted<float> one(1.0f, counts);
    Counted<float> depth;
    nearer_at(one, one, one, one, one, one, depth);
  });
}

}  // namespace beampipe
