// A surface that owns mask positions of a pixel.
#pragma once

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

  // The formats of an error and of a centroid's coordinate, for numbers and for numbers that count.
  template <class Float>
  static auto error_units(const Float& error) {
    const Float units = lesser(greater(error * Float(kErrorUnits), Float(-kLargestError)), Float(kLargestError));
    return to_integer(units + select(units < Float(0.0f), Float(-0.5f), Float(0.5f)));
  }
  template <class Float>
  static auto to_byte(const Float& x) {
    return to_bits(x * Float(255.0f) + Float(0.5f));
  }

  // Bits that say what the owner is, other than the number of its triangle.
  std::uint32_t content() const { return payload_ ^ (word_ >> 24) << 9; }

  void clear() { word_ = kMostTriangles; }
  void set(std::uint32_t number, float error, std::uint32_t covered, float u, float v) {
    word_ = number | error_bits(error);
    payload_ = covered | to_byte(u) << 16 | to_byte(v) << 24;
  }
  void set_merged(std::uint32_t number, float error, const glm::vec3& color, float threshold) {
    word_ = number | 1u << 23 | error_bits(error);
    payload_ = std::bit_cast<std::uint32_t>(SharedExponent(color, threshold));
  }

 private:
  static constexpr float kErrorUnits = 32.0f, kLargestError = 127.0f;

  static std::uint32_t error_bits(float error) { return static_cast<std::uint32_t>(error_units(error)) << 24; }

  std::uint32_t word_ = kMostTriangles;  // triangle, merged, error
  std::uint32_t payload_ = 0;
};
static_assert(sizeof(OwnerSlot) == 8);

// Size of a fragment between beam_fragment and compose in the modelled machine: pixel and facing (16 bits), triangle
// (24), centroid (16), area (16), mask, and depth plane and nearest depth as 4 x float32.
constexpr std::uint32_t owners_fragment_bytes(std::size_t words) {
  return 2 + 3 + 2 + 2 + static_cast<std::uint32_t>(words) * 4 + 16;
}

}  // namespace beampipe
