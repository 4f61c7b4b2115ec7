// The whole state of a pixel in streaming order: the owner of each mask position in the current pass, and what earlier
// passes have settled. Nothing is kept per fragment.
//
// A position is in one of Layers + 3 states, which are stored as bit planes. A layer stores only the index of a setup
// triangle, from which its depth plane, area and colour can be computed again, as in a visibility buffer (Burns and
// Hunt 2013).
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
  static constexpr std::uint32_t kFirstLayer = 1;         // layer 0 owns it; the next states are the other layers
  static constexpr std::uint32_t kDeferred = Layers + 1;  // its owner was dropped; another pass decides
  static constexpr std::uint32_t kSettled = Layers + 2;   // its owner is part of `color`
  static constexpr std::uint32_t kSpeck = 1u << 31;       // a flag in owner[0]: a speck may be visible

  PositionStates<Words, std::bit_width(kSettled)> states;
  std::uint32_t owner[Layers];  // triangle indices, below 2^31; owner[0] also has the flag kSpeck
  float dropped;                // the nearest depth of all dropped owners; kNoDepth if none was dropped
  HalfBits color[3];            // mean linear RGB of what is settled; a sum would lose precision in every pass
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

static_assert(sizeof(OwnerPixel<1, 1>) == 24);
static_assert(sizeof(OwnerPixel<2, 1>) == 32);
static_assert(sizeof(OwnerPixel<4, 1>) == 48);
static_assert(sizeof(OwnerPixel<8, 1>) == 80);
static_assert(sizeof(OwnerPixel<1, 5>) == 44);
static_assert(sizeof(OwnerPixel<2, 5>) == 56);
static_assert(sizeof(OwnerPixel<4, 5>) == 80);
static_assert(sizeof(OwnerPixel<8, 5>) == 128);

// The instances that exist: X(words, layers). Two bits of state are enough for 1 layer and three bits for 5 layers;
// other numbers of layers would waste states.
#define BEAMPIPE_OWNER_PIXELS(X) X(1, 1) X(2, 1) X(4, 1) X(8, 1) X(1, 5) X(2, 5) X(4, 5) X(8, 5)

// Size of a fragment between beam_fragment and claim in the modelled machine: pixel, triangle, mask, depth plane and
// nearest depth as float32.
constexpr std::uint32_t streaming_fragment_bytes(std::size_t words) {
  return 4 + 4 + static_cast<std::uint32_t>(words) * 4 + 12 + 4;
}

}  // namespace beampipe
