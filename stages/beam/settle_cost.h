// What settle and owners are charged.
#pragma once

#include <bit>

#include "simd/conserve.h"
#include "stages/cost/plane_cost.h"
#include "stages/data/owner_pixel.h"
#include "stages/data/pair.h"

namespace beampipe {

inline constexpr float kAreaUnits = 65535.0f;  // units of OwnerPixel::area in a whole pixel

// The population counts of a mask's words, and their sum.
inline void count_mask(OperationCounts& counts, std::size_t words) {
  Counted<float> sum;
  for (std::size_t w = 0; w < words; ++w) {
    const Counted<float> bits = bit_count(Counted<std::uint32_t>(0, counts));
    sum = w == 0 ? bits : sum + bits;
  }
}

// Per owner: the visible part of its positions, its area, its colour.
inline OperationCounts owner_cost(std::size_t words) {
  return count_operations([&](OperationCounts& counts) {
    using Real = Counted<float>;
    const Real one(1.0f, counts);
    count_mask(counts, words), count_mask(counts, words);
    one / one;  // the visible part, by which owners are sorted
    Taken<Real> taken{one, one};
    const Real area = select(true, one * one, visible_area(one, one, one, one, taken));  // with a speck or without
    taken = {taken.area + area, taken.positions + one};
    const Real share = area / one;
    for (int c = 0; c < 3; ++c) one + share* one;
  });
}

// Per pixel, in addition: the masks of its states, and its colour and area, which are converted from the stored formats
// and back.
template <std::size_t Words, std::size_t Layers>
OperationCounts pixel_cost() {
  using Pixel = OwnerPixel<Words, Layers>;
  constexpr std::size_t kBits = std::bit_width(Pixel::kSettled);
  OperationCounts masks;
  for (std::uint32_t state = Pixel::kFirstLayer; state <= Pixel::kSettled; ++state) masks += find_cost<kBits>(state);
  masks += put_cost<kBits>(Pixel::kSettled);
  masks += put_cost<kBits>(Pixel::kEmpty);
  masks.bit += Layers + 2;  // to join the owners' positions to the settled ones, and to find what is still deferred
  const OperationCounts numbers = count_operations([](OperationCounts& counts) {
    using Real = Counted<float>;
    const Real one(1.0f, counts), units(kAreaUnits);
    count_mask(counts, Words);  // settled positions
    Real area = to_float(Counted<std::int64_t>(0, counts)) / units, color[3] = {one, one, one};
    for (Real& channel : color) channel = converted(channel) * area;
    area = lesser(area * one, one);  // with the scale
    for (Real& channel : color) channel = converted(channel / area);
    to_integer(area * units + one);
  });
  OperationCounts all = masks * Words;
  return all += numbers;
}

// Per pixel that is finished, in addition: all positions become settled, undecided ones are counted, and the area is
// scaled.
template <std::size_t Words, std::size_t Layers>
OperationCounts finish_cost() {
  using Pixel = OwnerPixel<Words, Layers>;
  OperationCounts masks = find_cost<std::bit_width(Pixel::kSettled)>(Pixel::kEmpty);
  masks.bit += 2;
  OperationCounts all = masks * Words;
  return all += count_operations([](OperationCounts& counts) {
           const Counted<float> one(1.0f, counts);
           count_mask(counts, Words), count_mask(counts, Words);  // settled and deferred positions
           const Counted<float> inverse = one / one, rest = one / (one - one);
           select(one + one == one, inverse, lesser(rest, inverse));
         });
}

// Per pixel, to find which positions each layer owns.
template <std::size_t Words, std::size_t Layers>
OperationCounts owners_cost() {
  using Pixel = OwnerPixel<Words, Layers>;
  OperationCounts masks;
  for (std::uint32_t state = Pixel::kFirstLayer; state < Pixel::kDeferred; ++state)
    masks += find_cost<std::bit_width(Pixel::kSettled)>(state);
  return masks * Words;
}

// `claimed`: pixels that have owners.
template <std::size_t Words, std::size_t Layers>
void charge_owners(std::uint64_t claimed, std::uint64_t pairs, StageCounters& counters) {
  counters.ops += owners_cost<Words, Layers>() * claimed;
  counters.ops += pair_bounds_cost() * pairs;
  counters.ops += vertex_bounds_cost() * pairs;
  counters.bytes_read += claimed * sizeof(OwnerPixel<Words, Layers>);
  counters.bytes_written += pairs * kPairWithDepthBytes;
}

struct SettleWork {
  std::uint64_t fragments = 0;
  std::uint64_t pixels = 0;                   // that have owners
  std::uint64_t unfinished = 0;               // of these, pixels that need another pass
  std::uint64_t owners = 0, comparisons = 0;  // comparisons to sort the owners
};

template <std::size_t Words, std::size_t Layers>
void charge(const SettleWork& work, StageCounters& counters) {
  counters.items_in += work.fragments;
  counters.items_out += work.unfinished;
  counters.ops += pixel_cost<Words, Layers>() * work.pixels;
  counters.ops += finish_cost<Words, Layers>() * (work.pixels - work.unfinished);
  counters.ops += owner_cost(Words) * work.owners;
  counters.ops.add += work.comparisons;
  counters.bytes_read += work.pixels * sizeof(OwnerPixel<Words, Layers>);
  counters.bytes_read += work.fragments * streaming_fragment_bytes(Words);
  counters.bytes_written += work.pixels * sizeof(OwnerPixel<Words, Layers>);
  counters.lanes_used += work.fragments;
  counters.lanes_issued += work.fragments;
}

}  // namespace beampipe
