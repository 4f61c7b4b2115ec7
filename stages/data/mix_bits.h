// The last step of the hash function Murmur3: every bit of the result depends on every bit of `x`. It maps 0 to 0.
#pragma once

#include <cstdint>

namespace beampipe {

// Bits is std::uint32_t or a number that counts.
template <class Bits>
Bits mix_bits(Bits x) {
  x = (x ^ x >> 16) * Bits(0x85ebca6bu);
  x = (x ^ x >> 13) * Bits(0xc2b2ae35u);
  return x ^ x >> 16;
}

}  // namespace beampipe
