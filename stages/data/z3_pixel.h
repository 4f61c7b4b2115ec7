// A pixel of the Z3 technique: a few layers, and which of them owns each mask position.
#pragma once

#include <bit>
#include <cstddef>
#include <stdexcept>
#include <string>

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

static_assert(sizeof(Z3Pixel<1, 3>) == 50);
static_assert(sizeof(Z3Pixel<4, 3>) == 74);

// The instances that exist: X(words, layers).
#define BEAMPIPE_Z3_PIXELS(X) X(1, 3) X(4, 3)

// Calls shape.operator()<Words, Layers>() with the numbers of the instance. Throws std::invalid_argument if there is no
// such instance.
template <class Shape>
auto with_z3_shape(int positions, int layers, Shape&& shape) {
#define BEAMPIPE_SHAPE(words, shape_layers) \
  if (positions == 32 * words && layers == shape_layers) return shape.template operator()<words, shape_layers>();
  BEAMPIPE_Z3_PIXELS(BEAMPIPE_SHAPE)
#undef BEAMPIPE_SHAPE
  throw std::invalid_argument("no pixel has " + std::to_string(positions) + " positions and " + std::to_string(layers) +
                              " layers");
}

}  // namespace beampipe
