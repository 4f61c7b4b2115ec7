// One small number per mask position, packed as bit planes: plane b has bit b of every position's state.
#pragma once

#include <cstddef>
#include <cstdint>

#include "simd/wide_mask.h"

namespace beampipe {

template <std::size_t Words, std::size_t Bits>  // 32 positions a word; states below 2^Bits
struct PositionStates {
  std::uint32_t planes[Bits][Words];

  std::uint32_t at(std::size_t position) const {
    std::uint32_t state = 0;
    for (std::size_t b = 0; b < Bits; ++b) state |= (planes[b][position / 32] >> (position % 32) & 1) << b;
    return state;
  }

  bool all_in(std::uint32_t state) const {
    std::uint32_t all = ~0u;
    for (std::size_t w = 0; w < Words; ++w)
      for (std::size_t b = 0; b < Bits; ++b) all &= state >> b & 1 ? planes[b][w] : ~planes[b][w];
    return all == ~0u;
  }

  WideMask positions_in(std::uint32_t state) const {
    WideMask mask;
    for (std::size_t w = 0; w < Words; ++w) {
      std::uint32_t word = ~0u;
      for (std::size_t b = 0; b < Bits; ++b) word &= state >> b & 1 ? planes[b][w] : ~planes[b][w];
      mask.words[w] = word;
    }
    return mask;
  }

  void put(const WideMask& positions, std::uint32_t into) {
    for (std::size_t b = 0; b < Bits; ++b)
      for (std::size_t w = 0; w < Words; ++w)
        planes[b][w] = into >> b & 1 ? planes[b][w] | positions.words[w] : planes[b][w] & ~positions.words[w];
  }
};

}  // namespace beampipe
