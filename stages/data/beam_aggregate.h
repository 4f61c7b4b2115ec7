// The area-conserving aggregate as it is stored: loaded before each window of fragments and stored behind it, in
// exactly these bytes.
#pragma once

#include <cstddef>
#include <cstdint>

#include "simd/wide_mask.h"
#include "stages/data/half_bits.h"

namespace beampipe {

enum class Storage {
  packed,   // colour as 3 x fp16
  float32,  // colour as 3 x float32: what packing costs
};

#pragma pack(push, 2)
template <std::size_t Words, class Channel>  // 32 positions a word; Channel: HalfBits or float
struct StoredAggregate {
  std::uint32_t mask[Words];
  float area;        // 0..1
  Channel color[3];  // linear RGB times area
};
#pragma pack(pop)

static_assert(sizeof(StoredAggregate<1, HalfBits>) == 14);
static_assert(sizeof(StoredAggregate<2, HalfBits>) == 18);
static_assert(sizeof(StoredAggregate<4, HalfBits>) == 26);
static_assert(sizeof(StoredAggregate<8, HalfBits>) == 42);

// Bytes with so many positions.
constexpr std::uint32_t conserving_aggregate_bytes(int positions, Storage storage) {
  return static_cast<std::uint32_t>(positions) / 8 + 4 + (storage == Storage::packed ? 6 : 12);
}

}  // namespace beampipe
