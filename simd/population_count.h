// How many bits are set. The base instruction set has no instruction for it, so std::popcount calls a function.
#pragma once

#include <cstdint>

namespace beampipe {

// Sums neighbours: pairs of bits, then nibbles, then bytes.
constexpr std::uint32_t population_count(std::uint32_t bits) {
  bits -= bits >> 1 & 0x55555555u;
  bits = (bits & 0x33333333u) + (bits >> 2 & 0x33333333u);
  bits = (bits + (bits >> 4)) & 0x0f0f0f0fu;
  return bits * 0x01010101u >> 24;
}

}  // namespace beampipe
