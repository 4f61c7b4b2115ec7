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

// The whole state of a pixel. Z3 has a mask per layer. The masks of opaque layers are disjoint, so an owner per
// position says the same in fewer bits: 0 for no owner, k + 1 for layer k.
template <std::size_t Words, std::size_t Layers>  // 32 positions a word
struct Z3Pixel {
  PositionStates<Words, std::bit_width(Layers)> owners;
  Z3Layer layers[Layers];
};
#pragma pack(pop)

static_assert(sizeof(Z3Pixel<1, 2>) == 36);
static_assert(sizeof(Z3Pixel<1, 3>) == 50);
static_assert(sizeof(Z3Pixel<4, 3>) == 74);

// The instances that exist: X(words, layers).
#define BEAMPIPE_Z3_PIXELS(X) X(1, 2) X(1, 3) X(4, 3)

}  // namespace beampipe
