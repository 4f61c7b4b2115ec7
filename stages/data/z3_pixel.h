// A pixel of the Z3 technique: a few layers, and which of them owns each mask position.
#pragma once

#include <bit>
#include <cstddef>

#include "stages/data/half_bits.h"
#include "stages/data/position_states.h"

namespace beampipe {

#pragma pack(push, 2)
struct Z3Layer {
  float z;              // at the pixel's centre
  UpperHalf slopes[2];  // per pixel along u and v
  HalfBits color[3];    // linear RGB
};

inline constexpr std::size_t kZ3Layers = 3, kZ3Planes = std::bit_width(kZ3Layers);  // bit planes of owners

// The whole state of a pixel. Z3 has a mask per layer. The masks of opaque layers are disjoint, so an owner per
// position says the same in fewer bits: 0 for no owner, k + 1 for layer k.
template <std::size_t Words>  // 32 positions a word
struct Z3Pixel {
  PositionStates<Words, kZ3Planes> owners;
  Z3Layer layers[kZ3Layers];
};
#pragma pack(pop)

static_assert(sizeof(Z3Pixel<1>) == 50);
static_assert(sizeof(Z3Pixel<4>) == 74);

}  // namespace beampipe
