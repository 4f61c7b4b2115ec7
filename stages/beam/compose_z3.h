// compose_z3: fragments in primitive order -> a few layers per pixel, in one pass. The prior art of streaming order: Z3
// (Jouppi and Chang 1999).
//
// A fragment takes the positions where it is nearer than their owners; at equal depth the earlier one keeps them. When
// a pixel has a layer too many, two become one: those that are closest in depth, as Z3 has it, or those whose colours
// lose least. A layer's weight is its share of the positions; what covers no position is lost.
#pragma once

#include <vector>

#include "stages/beam/beam_fragment.h"
#include "stages/data/half_bits.h"
#include "stages/data/position_set.h"
#include "stages/data/position_states.h"
#include "stages/picture/resolve.h"

namespace beampipe {

enum class LayerMerge {
  depth,  // least difference of depth at the pixel's centre
  color,  // least squared distance of colours, times n m / (n + m) of positions: what the merged mean loses
};

#pragma pack(push, 2)
struct Z3Layer {
  float z;              // at the pixel's centre
  UpperHalf slopes[2];  // per pixel along u and v
  HalfBits color[3];    // linear RGB
};

// The whole state of a pixel. Z3 has a mask per layer; masks of opaque layers are disjoint, so that an owner per
// position says the same in fewer bits: 0 none, k + 1 layer k.
template <std::size_t Words, std::size_t Layers>  // 32 positions a word
struct Z3Pixel {
  PositionStates<Words, std::bit_width(Layers)> owners;
  Z3Layer layers[Layers];
};
#pragma pack(pop)

static_assert(sizeof(Z3Pixel<1, 2>) == 36);
static_assert(sizeof(Z3Pixel<1, 3>) == 50);
static_assert(sizeof(Z3Pixel<4, 3>) == 74);

// The shapes that there are: X(words, layers).
#define BEAMPIPE_Z3_PIXELS(X) X(1, 2) X(1, 3) X(4, 3)

// `pixels`: one per pixel of the tile, kept from batch to batch; zero before the first. `merges` beside them: one is
// added where two layers become one.
template <std::size_t Words, std::size_t Layers>
void compose_z3(const std::vector<Fragment>& fragments, const PositionSet& positions, LayerMerge merge,
                StageCounters& counters, std::vector<Z3Pixel<Words, Layers>>& pixels, std::vector<float>& merges);

template <std::size_t Words, std::size_t Layers>
std::vector<PixelColor> z3_colors(const std::vector<Z3Pixel<Words, Layers>>& pixels);

}  // namespace beampipe
