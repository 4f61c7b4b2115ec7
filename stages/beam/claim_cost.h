// What claim is charged.
#pragma once

#include <array>

#include "stages/cost/plane_cost.h"
#include "stages/data/owner_pixel.h"

namespace beampipe {

// How often each operation was done. States: the number of states that a position may have.
template <std::size_t States>
struct ClaimWork {
  std::uint64_t fragments = 0;
  std::uint64_t masks = 0;                                  // fragments that cover a position
  std::uint64_t claims = 0;                                 // fragments that took a position
  std::uint64_t rooms_made = 0;                             // searches for the farthest owner
  std::uint64_t planes_made = 0, planes_compared = 0;       // of owners; at all positions
  std::uint64_t nearest_found = 0;                          // nearest depths of a plane over a mask
  std::uint64_t specks_looked_up = 0, specks_compared = 0;  // positions next to specks
  std::array<std::uint64_t, States> put{};                  // masks of positions put into each state
};

template <class Pixel>
constexpr std::size_t kStateBits = std::bit_width(Pixel::kSettled);

// Per position, to find the nearest depth of a plane.
inline OperationCounts nearest_cost() {
  return count_operations([](OperationCounts& counts) {
    const Counted<float> one(1.0f, counts);
    nearest_formula({one, one, one}, one, one, true, one);
  });
}

// Per word of a fragment's mask: to find the positions that are empty, deferred and owned by each layer, intersect each
// with the mask and, except for the empty ones, with the positions where the fragment is nearer; and to join the
// results.
template <std::size_t Layers, class Pixel>
OperationCounts contest_cost() {
  OperationCounts counts = find_cost<kStateBits<Pixel>>(Pixel::kEmpty);
  for (std::uint32_t state = Pixel::kFirstLayer; state <= Pixel::kDeferred; ++state)
    counts += find_cost<kStateBits<Pixel>>(state);
  counts.bit += (Layers + 2) + 2 * (Layers + 1);
  return counts;
}

// Per word, when the farthest owner is searched: each layer's positions without those that are claimed.
template <std::size_t Layers, class Pixel>
OperationCounts room_cost() {
  OperationCounts counts;
  for (std::uint32_t state = Pixel::kFirstLayer; state < Pixel::kDeferred; ++state)
    counts += find_cost<kStateBits<Pixel>>(state);
  counts.bit += 2 * Layers;
  return counts;
}

// Per position next to a speck: its number and its state. If it has an owner: whether that is nearer at the speck's
// centroid.
inline OperationCounts speck_state_cost(std::size_t bits) { return {.add = 1, .bit = 2 * bits, .fetch = 1}; }
inline OperationCounts speck_depth_cost() {
  return count_operations([](OperationCounts& counts) {
    const Counted<float> one(1.0f, counts), half(0.5f);
    static_cast<void>(one <= depth_at(DepthPlane<Counted<float>>{one, one, one}, one - half, one - half));
  });
}

template <std::size_t Words, std::size_t Layers>
void charge(const ClaimWork<OwnerPixel<Words, Layers>::kSettled + 1>& work, StageCounters& counters) {
  using Pixel = OwnerPixel<Words, Layers>;
  constexpr std::uint64_t kPositions = 32 * Words;
  counters.items_in += work.fragments;
  counters.items_out += work.claims;
  counters.ops += contest_cost<Layers, Pixel>() * (Words * work.masks);
  counters.ops += nearer_cost() * (kPositions * work.planes_compared);
  counters.ops += room_cost<Layers, Pixel>() * (Words * work.rooms_made);
  counters.ops += nearest_cost() * (kPositions * work.nearest_found);
  counters.ops.add += work.rooms_made * (Layers + 1);  // to find the farthest, and to update the pixel's dropped depth
  counters.ops += plane_cost() * work.planes_made;
  for (std::uint32_t state = 0; state < work.put.size(); ++state)
    counters.ops += put_cost<kStateBits<Pixel>>(state) * (Words * work.put[state]);
  counters.ops += speck_state_cost(kStateBits<Pixel>) * work.specks_looked_up;
  counters.ops += speck_depth_cost() * work.specks_compared;
  counters.bytes_read += work.fragments * (streaming_fragment_bytes(Words) + sizeof(Pixel));
  counters.bytes_read += work.planes_made * sizeof(ScreenDepth);
  counters.bytes_written += work.claims * sizeof(Pixel);
  counters.position_tests += kPositions * (work.planes_compared + work.nearest_found);
  counters.lanes_used += work.claims;
  counters.lanes_issued += work.fragments;
}

}  // namespace beampipe
