// A surface that owns mask positions of a pixel.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <glm/glm.hpp>

#include "simd/scalar.h"
#include "stages/data/shared_exponent.h"

namespace beampipe {

// One owner, in 8 bytes. A surface that came from one triangle is shaded when it becomes final; until then it needs no
// colour, only the place to shade it at. A surface that came from several has the mean of their colours, and the depth
// plane of the one with the most positions.
class OwnerSlot {
 public:
  // The number of a triangle in the bin's list has 23 bits.
  static constexpr std::uint32_t kMostTriangles = (1u << 23) - 1;

  OwnerSlot() = default;
  explicit OwnerSlot(const std::array<std::uint32_t, 2>& words) : word_(words[0]), payload_(words[1]) {}

  bool is_free() const { return triangle() == kMostTriangles; }
  std::uint32_t triangle() const { return word_ & kMostTriangles; }
  bool is_merged() const { return word_ >> 23 & 1; }

  // The error that the mask makes for the surface: its exact area, times the number of positions in a pixel, minus the
  // positions that it covers. From -4 to almost 4, in steps of 1/32.
  float error() const { return static_cast<float>(static_cast<std::int8_t>(word_ >> 24)) / kErrorUnits; }

  bool error_is_limited() const { return magnitude(error()) >= kLargestError / kErrorUnits; }

  // Of a surface from one triangle: how many positions it covers, and its centroid in the pixel, 0..1.
  float covered() const { return static_cast<float>(payload_ & 0xffff); }
  glm::vec2 centroid() const { return glm::vec2(payload_ >> 16 & 0xff, payload_ >> 24) * (1.0f / 255.0f); }

  // Of a merged surface; linear RGB.
  glm::vec3 color() const { return std::bit_cast<SharedExponent>(payload_); }

  // The formats, for numbers and for numbers that count: of a surface from one triangle, and of a merged one.
  template <class Bits, class Float>
  static std::array<Bits, 2> words_of(const Bits& number, const Float& error, const Bits& covered, const Float& u,
                                      const Float& v) {
    return {number | error_bits(error), covered | to_byte(u) << 16 | to_byte(v) << 24};
  }
  template <class Bits, class Float>
  static std::array<Bits, 2> words_of_merged(const Bits& number, const Float& error, const Float (&color)[3],
                                             const Float& threshold) {
    return {number | Bits(1u << 23) | error_bits(error), SharedExponent::pack(color, threshold)};
  }

  // Bits that say what the owner is, other than the number of its triangle.
  template <class Bits>
  static Bits content_of(const Bits& word, const Bits& payload) {
    return payload ^ (word >> 24) << 9;
  }
  std::uint32_t content() const { return content_of(word_, payload_); }

  void clear() { word_ = kMostTriangles; }
  void set(std::uint32_t number, float error, std::uint32_t covered, float u, float v) {
    *this = OwnerSlot(words_of(number, error, covered, u, v));
  }

 private:
  static constexpr float kErrorUnits = 32.0f, kLargestError = 127.0f;

  template <class Float>
  static auto error_bits(const Float& error) {
    const Float units = lesser(greater(error * Float(kErrorUnits), Float(-kLargestError)), Float(kLargestError));
    return bits_of(to_integer(units + select(units < Float(0.0f), Float(-0.5f), Float(0.5f)))) << 24;
  }
  template <class Float>
  static auto to_byte(const Float& x) {
    return to_bits(x * Float(255.0f) + Float(0.5f));
  }

  std::uint32_t word_ = kMostTriangles;  // triangle, merged, error
  std::uint32_t payload_ = 0;
};
static_assert(sizeof(OwnerSlot) == 8);

// Size of a fragment between beam_fragment and compose in the modelled machine: pixel and facing (16 bits), triangle
// (24), centroid (16), area (16), mask, and depth plane and nearest depth as 4 x float32.
constexpr std::uint32_t owners_fragment_bytes(std::size_t words) {
  return 2 + 3 + 2 + 2 + static_cast<std::uint32_t>(words) * 4 + 16;
}

// Of one that covers its whole pixel: without centroid, area and mask.
inline constexpr std::uint32_t kOwnersWholeFragmentBytes = 2 + 3 + 16;

}  // namespace beampipe
