// The positions of a pixel by their state (stages/data/owner_pixel.h), as numbers that count, for the scalar twins of
// claim and settle.
#pragma once

#include <array>
#include <bit>

#include "stages/cost/counting.h"
#include "stages/data/owner_pixel.h"

namespace beampipe {

template <std::size_t Words>
using CountedMask = std::array<Counted<std::uint32_t>, Words>;

template <std::size_t Words, std::size_t Layers>
CountedMask<Words> find_counted(const OwnerPixel<Words, Layers>& pixel, std::uint32_t state, OperationCounts& counts) {
  constexpr std::size_t kBits = std::bit_width(OwnerPixel<Words, Layers>::kSettled);
  CountedMask<Words> mask;
  for (std::size_t w = 0; w < Words; ++w) {
    std::array<Counted<std::uint32_t>, kBits> planes;
    for (std::size_t b = 0; b < kBits; ++b) planes[b] = Counted<std::uint32_t>(pixel.states.planes[b][w], counts);
    mask[w] = word_in_state(planes, state);
  }
  return mask;
}

template <std::size_t Words, std::size_t Layers>
void put_counted(const CountedMask<Words>& mask, std::uint32_t state, OwnerPixel<Words, Layers>& pixel,
                 OperationCounts& counts) {
  constexpr std::size_t kBits = std::bit_width(OwnerPixel<Words, Layers>::kSettled);
  for (std::size_t w = 0; w < Words; ++w) {
    for (std::size_t b = 0; b < kBits; ++b) {
      std::uint32_t& plane = pixel.states.planes[b][w];
      plane = word_put(Counted<std::uint32_t>(plane, counts), mask[w], state >> b & 1).value;
    }
  }
}

template <std::size_t Words>
CountedMask<Words> either(CountedMask<Words> a, const CountedMask<Words>& b) {
  for (std::size_t w = 0; w < Words; ++w) a[w] = a[w] | b[w];
  return a;
}

}  // namespace beampipe
