// 16-bit floats for use in packed structs.
#pragma once

#include <half.h>

#include <algorithm>
#include <bit>
#include <cstdint>

namespace beampipe {

// An fp16 number. Values beyond the largest and the least fp16 number become these.
struct HalfBits {
  static constexpr float kMost = HALF_MAX;
  std::uint16_t bits = 0;

  HalfBits() = default;
  explicit HalfBits(float value) : bits(half(std::clamp(value, -kMost, kMost)).bits()) {}
  operator float() const {
    half value;
    value.setBits(bits);
    return value;
  }
};

// The upper half of a float32, rounded. It has the range of a float32, which depth slopes need: they go down to 1e-9
// per pixel.
struct UpperHalf {
  std::uint16_t bits = 0;

  UpperHalf() = default;
  explicit UpperHalf(float value)
      : bits(static_cast<std::uint16_t>((std::bit_cast<std::uint32_t>(value) + 0x8000u) >> 16)) {}
  operator float() const { return std::bit_cast<float>(std::uint32_t{bits} << 16); }
};

}  // namespace beampipe
