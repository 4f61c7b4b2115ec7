// The area-conserving aggregate as it is stored, in exactly these bytes. It is loaded at the start of each window of
// fragments and stored at the end.
#pragma once

#include <cstddef>
#include <cstdint>

#include "simd/wide_mask.h"
#include "stages/data/half_bits.h"

namespace beampipe {

#pragma pack(push, 2)
template <std::size_t Words>  // 32 positions a word
struct StoredAggregate {
  std::uint32_t mask[Words];  // positions that are taken
  float area;                 // 0..1
  HalfBits color[3];          // linear RGB times area
};
#pragma pack(pop)

static_assert(sizeof(StoredAggregate<1>) == 14);
static_assert(sizeof(StoredAggregate<8>) == 42);

// Size of a fragment between beam_fragment and compose in the modelled machine: pixel, colour (3 x fp16), area, mask,
// depth plane (3 x float32), and the centroid with the facing (2 x 16 bits).
constexpr std::uint32_t conserving_fragment_bytes(int positions) {
  return 4 + 6 + 4 + static_cast<std::uint32_t>(positions) / 8 + 12 + 4;
}

}  // namespace beampipe
