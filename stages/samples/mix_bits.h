// Murmur3's finalizer: every bit of the result depends on every bit of `x`.
#pragma once

#include <cstdint>

namespace beampipe {

template <class Bits>
Bits mix_bits(Bits x) {
  x = (x ^ x >> 16) * Bits(0x85ebca6bu);
  x = (x ^ x >> 13) * Bits(0xc2b2ae35u);
  return x ^ x >> 16;
}

}  // namespace beampipe
