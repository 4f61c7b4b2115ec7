// The whole state of a pixel in streaming order: who owns each mask position in this pass, what the passes before have
// settled, and nothing per fragment.
//
// A position is in one of Layers + 3 states, kept as bit planes. A layer is the number of a setup triangle, from which
// its depth plane, area and colour follow, as in a visibility buffer (Burns and Hunt 2013).
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>

#include "simd/plane_order.h"
#include "stages/data/half_bits.h"
#include "stages/data/position_states.h"

namespace beampipe {

template <std::size_t Words, std::size_t Layers>  // 32 positions a word
struct OwnerPixel {
  // States of a position: kEmpty, owned by layer 0 .. Layers - 1, kDeferred, kSettled.
  static constexpr std::uint32_t kEmpty = 0;              // nothing covers it yet
  static constexpr std::uint32_t kFirstLayer = 1;         // this and the next ones: that layer owns it
  static constexpr std::uint32_t kDeferred = Layers + 1;  // its owner was dropped: another pass decides
  static constexpr std::uint32_t kSettled = Layers + 2;   // its owner is in `color`
  static constexpr std::uint32_t kSpeck = 1u << 31;       // in owner[0]

  PositionStates<Words, std::bit_width(kSettled)> states;
  std::uint32_t owner[Layers];  // below 2^31; kSpeck: something that covers no position may be seen
  float dropped;                // at no deferred position was there anything nearer; kNoDepth when none is
  HalfBits color[3];            // mean linear RGB of what is settled: a sum would lose a little in every pass
  std::uint16_t area;           // of what is settled, in 1/65535 of the pixel

  WideMask positions_in(std::uint32_t state) const { return states.positions_in(state); }
  void put(const WideMask& positions, std::uint32_t into) { states.put(positions, into); }
  std::uint32_t triangle(std::size_t layer) const { return owner[layer] & ~kSpeck; }
  void set_triangle(std::size_t layer, std::uint32_t index) { owner[layer] = (owner[layer] & kSpeck) | index; }
};

template <std::size_t Words, std::size_t Layers>
OwnerPixel<Words, Layers> cleared_pixel() {
  OwnerPixel<Words, Layers> pixel{};
  pixel.dropped = kNoDepth;
  return pixel;
}

// What is stored is what is claimed.
static_assert(sizeof(OwnerPixel<1, 1>) == 24);
static_assert(sizeof(OwnerPixel<2, 1>) == 32);
static_assert(sizeof(OwnerPixel<4, 1>) == 48);
static_assert(sizeof(OwnerPixel<8, 1>) == 80);
static_assert(sizeof(OwnerPixel<1, 5>) == 44);
static_assert(sizeof(OwnerPixel<2, 5>) == 56);
static_assert(sizeof(OwnerPixel<4, 5>) == 80);
static_assert(sizeof(OwnerPixel<8, 5>) == 128);

// The shapes that there are: X(words, layers). Two bits of state hold 1 layer, three hold 5; others would waste some.
#define BEAMPIPE_OWNER_PIXELS(X) X(1, 1) X(2, 1) X(4, 1) X(8, 1) X(1, 5) X(2, 5) X(4, 5) X(8, 5)

}  // namespace beampipe
