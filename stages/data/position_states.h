// A state (a small number) for each mask position, stored as bit planes: plane b has bit b of every position's state.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "simd/wide_mask.h"

namespace beampipe {

// ---- One word of 32 positions; Word is std::uint32_t or a number that counts ----

// Returns the positions that are in `state`. `planes`: one word of each bit plane.
template <class Word, std::size_t Bits>
Word word_in_state(const std::array<Word, Bits>& planes, std::uint32_t state) {
  Word word = state & 1 ? planes[0] : ~planes[0];
  for (std::size_t b = 1; b < Bits; ++b) word = word & (state >> b & 1 ? planes[b] : ~planes[b]);
  return word;
}

// Returns a bit plane's word after `positions` were put into a state. `set`: does the state have this plane's bit?
template <class Word>
Word word_put(Word plane, Word positions, bool set) {
  return set ? plane | positions : plane & ~positions;
}

template <std::size_t Words, std::size_t Bits>  // 32 positions a word; states below 2^Bits
struct PositionStates {
  std::uint32_t planes[Bits][Words];

  std::uint32_t at(std::size_t position) const {
    std::uint32_t state = 0;
    for (std::size_t b = 0; b < Bits; ++b) state |= (planes[b][position / 32] >> (position % 32) & 1) << b;
    return state;
  }

  // The loops over words have no branches, so that compilers use vectors.
  WideMask positions_in(std::uint32_t state) const {
    WideMask mask;
    for (std::size_t w = 0; w < Words; ++w) mask.words[w] = ~0u;
    for (std::size_t b = 0; b < Bits; ++b) {
      const std::uint32_t flipped = state >> b & 1 ? 0 : ~0u;
      for (std::size_t w = 0; w < Words; ++w) mask.words[w] &= planes[b][w] ^ flipped;
    }
    return mask;
  }

  void put(const WideMask& positions, std::uint32_t into) {
    for (std::size_t b = 0; b < Bits; ++b) {
      if (into >> b & 1) {
        for (std::size_t w = 0; w < Words; ++w) planes[b][w] = word_put(planes[b][w], positions.words[w], true);
      } else {
        for (std::size_t w = 0; w < Words; ++w) planes[b][w] = word_put(planes[b][w], positions.words[w], false);
      }
    }
  }
};

}  // namespace beampipe
