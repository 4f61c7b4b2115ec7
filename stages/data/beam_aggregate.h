// The area-conserving aggregate as it is stored, in exactly these bytes. It is loaded at the start of each window of
// fragments and stored at the end.
#pragma once

#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>

#include "simd/wide_mask.h"
#include "stages/data/half_bits.h"

namespace beampipe {

enum class Storage {
  packed,   // colour as 3 x fp16
  float32,  // colour as 3 x float32: shows what packing costs
};

#pragma pack(push, 2)
template <std::size_t Words, class Channel>  // 32 positions a word; Channel: HalfBits or float
struct StoredAggregate {
  std::uint32_t mask[Words];  // positions that are taken
  float area;                 // 0..1
  Channel color[3];           // linear RGB times area
};
#pragma pack(pop)

static_assert(sizeof(StoredAggregate<1, HalfBits>) == 14);
static_assert(sizeof(StoredAggregate<2, HalfBits>) == 18);
static_assert(sizeof(StoredAggregate<4, HalfBits>) == 26);
static_assert(sizeof(StoredAggregate<8, HalfBits>) == 42);

// Size of an aggregate with this many positions.
constexpr std::uint32_t conserving_aggregate_bytes(int positions, Storage storage) {
  return static_cast<std::uint32_t>(positions) / 8 + 4 + (storage == Storage::packed ? 6 : 12);
}

// Size of a fragment between beam_fragment and compose in the modelled machine: pixel, colour (3 x fp16), area, mask,
// depth plane (3 x float32), and the centroid with the facing (2 x 16 bits).
constexpr std::uint32_t conserving_fragment_bytes(int positions) {
  return 4 + conserving_aggregate_bytes(positions, Storage::packed) + 12 + 4;
}

// The instances that exist: X(words, channel).
#define BEAMPIPE_STORED_AGGREGATES(X) X(1, HalfBits) X(8, HalfBits) X(8, float)

// Calls shape.operator()<Words, Channel>() with the types of the instance. Throws std::invalid_argument if there is no
// such instance.
template <class Shape>
auto with_aggregate(int positions, Storage storage, Shape&& shape) {
#define BEAMPIPE_SHAPE(words, channel)                                                                   \
  if (positions == 32 * words && storage == (sizeof(channel) == 2 ? Storage::packed : Storage::float32)) \
    return shape.template operator()<words, channel>();
  BEAMPIPE_STORED_AGGREGATES(BEAMPIPE_SHAPE)
#undef BEAMPIPE_SHAPE
  throw std::invalid_argument("no aggregate has " + std::to_string(positions) + " positions in this storage");
}

}  // namespace beampipe
