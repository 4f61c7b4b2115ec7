// 16-bit floats for use in packed structs.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>

namespace beampipe {

// The bits of the nearest fp16 number; of two that are equally near, the one whose last bit is 0. Infinity from 65520
// on.
inline std::uint16_t half_of(float value) {
  constexpr std::uint32_t kNormal = 113u << 23, kTooLarge = 143u << 23, kInfinity = 255u << 23;  // 2^-14, 2^16
  constexpr std::uint32_t kRebias = 112u << 23;  // between the exponents of a float32 and an fp16 number
  const std::uint32_t bits = std::bit_cast<std::uint32_t>(value), magnitude = bits & 0x7fffffffu;
  std::uint32_t rounded = magnitude > kInfinity ? 0x7e00u : 0x7c00u;
  if (magnitude < kNormal) {  // fp16 numbers have steps of 2^-24 there, and so has the sum
    rounded = std::bit_cast<std::uint32_t>(std::bit_cast<float>(magnitude) + 0.5f) - std::bit_cast<std::uint32_t>(0.5f);
  } else if (magnitude < kTooLarge) {
    rounded = (magnitude - kRebias + 0xfffu + (magnitude >> 13 & 1u)) >> 13;
  }
  return static_cast<std::uint16_t>((bits >> 16 & 0x8000u) | rounded);
}

// The value of an fp16 number.
inline float half_value(std::uint16_t bits) {
  const std::uint32_t magnitude = bits & 0x7fffu, sign = (bits & 0x8000u) << 16;
  const float value = magnitude < 0x400u    ? static_cast<float>(magnitude) * 0x1p-24f
                      : magnitude < 0x7c00u ? std::bit_cast<float>((magnitude << 13) + (112u << 23))
                                            : std::bit_cast<float>(magnitude << 13 | 255u << 23);
  return std::bit_cast<float>(std::bit_cast<std::uint32_t>(value) | sign);
}

// The value of the nearest fp16 number, or infinity: half_of().
inline float nearest_half(float value) { return half_value(half_of(value)); }

// An fp16 number. Values beyond the largest and the least fp16 number become these.
struct HalfBits {
  static constexpr float kMost = 65504;
  std::uint16_t bits = 0;

  HalfBits() = default;
  [[gnu::always_inline]] explicit HalfBits(float value) : bits(half_of(std::clamp(value, -kMost, kMost))) {}
  operator float() const { return half_value(bits); }
};

// The value of HalfBits(value), found without its bits: a float32 whose last 13 bits are rounded away, or a multiple of
// 2^-24.
inline float rounded_to_half(float value) {
  const std::uint32_t bits = std::bit_cast<std::uint32_t>(std::clamp(value, -HalfBits::kMost, HalfBits::kMost));
  const std::uint32_t magnitude = bits & 0x7fffffffu;
  const std::uint32_t normal = (magnitude + 0xfffu + (magnitude >> 13 & 1u)) & ~0x1fffu;
  const std::uint32_t small = std::bit_cast<std::uint32_t>((std::bit_cast<float>(magnitude) + 0.5f) - 0.5f);
  return std::bit_cast<float>((magnitude < 113u << 23 ? small : normal) | (bits & 0x80000000u));
}

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
