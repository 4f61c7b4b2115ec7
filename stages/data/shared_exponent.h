// A colour in four bytes: three mantissas and one exponent (Ward 1991, "Real Pixels").
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <type_traits>

#include "simd/scalar.h"

namespace beampipe {

struct SharedExponent {
  std::uint8_t mantissa[3] = {}, exponent = 0;  // exponent 0: black

  SharedExponent() = default;

  // The formula, for numbers and for numbers that count: three bytes of mantissas and one of the exponent.
  template <class Float>
  static auto pack(const Float (&color)[3], const Float& threshold) {
    const Float zero(0.0f), largest = greater(greater(color[0], color[1]), greater(color[2], zero));
    // A power of two above the largest channel; what would be rounded up to 256 takes the next one. 2^-100 and less is
    // black; from 2^127 on, channels stop at 255 steps.
    const auto exponent = bits_of(largest * Float(1 + 0x1p-8f)) >> 23;  // of float32, whose bias is 127
    using Word = std::remove_const_t<decltype(bits_of(zero) >> 23)>;
    const Word power = lesser(exponent + Word(1), Word(127 + 127));
    const bool is_black = !(largest > Float(0x1p-100f));
    const Float per_unit = float_of((Word(8 + 127 + 127) - power) << 23);
    Word packed(0);
    for (int c = 0; c < 3; ++c)
      packed = packed | to_bits(lesser(greater(color[c] * per_unit + Float(1.0f) - threshold, zero), Float(255.0f)))
                            << 8 * c;
    return select(is_black, Word(0), packed | (power + Word(1)) << 24);
  }

  // `color`: linear RGB; negative channels become 0. The error of a channel is at most 1/127 of the largest channel.
  // `threshold`, above 0 and up to 1: the part of a step above it counts as a whole step. If it differs from case to
  // case, a colour that is changed a little many times is right on average.
  SharedExponent(const glm::vec3& color, float threshold) {
    const float channels[] = {color[0], color[1], color[2]};
    *this = std::bit_cast<SharedExponent>(pack(channels, threshold));
  }

  operator glm::vec3() const {
    if (exponent == 0) return glm::vec3(0.0f);
    const float unit = std::ldexp(1.0f, exponent - 128 - 8);
    return unit * glm::vec3(mantissa[0], mantissa[1], mantissa[2]);
  }
};
static_assert(sizeof(SharedExponent) == 4);

}  // namespace beampipe
