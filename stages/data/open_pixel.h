// All that a pixel keeps while its bin is open: which surface owns which mask position, and the sums of what is final.
// It is loaded and stored for every fragment, as an aggregate is.
//
// Owners are surfaces that later fragments may still hide. Their number is fixed; if there is one more, two of them
// become one (stages/beam/compose_owners.h).
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <glm/glm.hpp>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "simd/depth_plane.h"
#include "simd/scalar.h"
#include "stages/data/position_states.h"
#include "stages/data/shared_exponent.h"

namespace beampipe {

// A number from 0 to almost 2 in 16 bits. Sums of areas and colours are kept in it: a sum of fp16 numbers stops growing
// when addends are small.
struct FixedSum {
  static constexpr float kUnits = 32768.0f;
  std::uint16_t units = 0;

  operator float() const { return static_cast<float>(units) / kUnits; }
  // `threshold`: 0..1, different for each addend. The part of a unit above it counts as a whole unit, so that many
  // small addends are right on average.
  void add(float x, float threshold) {
    const auto sum = static_cast<std::int32_t>(units) + static_cast<std::int32_t>(x * kUnits + 1.0f - threshold);
    units = static_cast<std::uint16_t>(std::clamp(sum, 0, 0xffff));
  }
};

// Sums of colours: RGB by analytic area, and RGB by counted positions, in 12 bytes. Each has 15 bits; the sixteenth
// bits together are the exponent of all six, which grows with the largest sum. Colours are linear RGB times area.
class ColorSums {
 public:
  static constexpr std::size_t kCount = 6;

  float operator[](std::size_t i) const {
    const Words words = load();
    return static_cast<float>(words[i] & kLargest) * unit(exponent(words));
  }

  // `addends` are not negative. `threshold`: as in FixedSum.
  void add(const float (&addends)[kCount], float threshold) {
    Words words = load();
    const int before = exponent(words);
    for (std::uint32_t& word : words) word &= kLargest;
    int power = std::max(before, least_exponent(addends));
    for (std::uint32_t& sum : words) sum = halved(sum, power - before);
    for (; power < kMostExponent && !fits(words, addends, per_unit(power)); ++power)
      for (std::uint32_t& sum : words) sum = halved(sum, 1);
    const float scale = per_unit(power);
    for (std::size_t i = 0; i < kCount; ++i) {
      const float units = std::min(addends[i] * scale, static_cast<float>(kLargest));
      const std::uint32_t sum = words[i] + static_cast<std::uint32_t>(units + 1.0f - threshold);
      words[i] = std::min(sum, kLargest) | (static_cast<std::uint32_t>(power) >> i & 1) << 15;
    }
    store(words);
  }

 private:
  static constexpr std::uint32_t kLargest = 0x7fff;
  static constexpr int kMostExponent = 63;
  using Words = std::array<std::uint32_t, kCount>;  // of 16 bits

  // Units from 2^-40, so that sums up to 2^-25 are exact to that, to 2^23.
  static float unit(int power) { return std::bit_cast<float>(static_cast<std::uint32_t>(power - 40 + 127) << 23); }
  static float per_unit(int power) { return std::bit_cast<float>(static_cast<std::uint32_t>(40 - power + 127) << 23); }

  // The largest addend does not fit with any smaller exponent, whatever the sums are: it would be 2^15 units or more.
  static int least_exponent(const float (&addends)[kCount]) {
    std::uint32_t largest = 0;  // floats that are not negative are in the order of their bits
    for (const float addend : addends) largest = std::max(largest, std::bit_cast<std::uint32_t>(addend) & 0x7fffffff);
    return std::min(static_cast<int>(largest >> 23) - 127 + 40 - 14, kMostExponent);
  }

  // Rounded up, as if it were halved again and again.
  static std::uint32_t halved(std::uint32_t sum, int times) {
    const int shift = std::min(times, 15);
    return (sum + (1u << shift) - 1) >> shift;
  }

  static bool fits(const Words& sums, const float (&addends)[kCount], float per_unit) {
    for (std::size_t i = 0; i < kCount; ++i)
      if (!(static_cast<float>(sums[i]) + addends[i] * per_unit + 1.0f < static_cast<float>(kLargest))) return false;
    return true;
  }

  static int exponent(const Words& words) {
    std::uint32_t power = 0;
    for (std::size_t i = 0; i < kCount; ++i) power |= words[i] >> 15 << i;
    return static_cast<int>(power);
  }

  // The words are loaded and stored together: a load of several waits if they were stored one by one just before.
  Words load() const {
    std::uint32_t pairs[kCount / 2];
    std::memcpy(pairs, words_, sizeof pairs);
    return {pairs[0] & 0xffff, pairs[0] >> 16, pairs[1] & 0xffff, pairs[1] >> 16, pairs[2] & 0xffff, pairs[2] >> 16};
  }
  void store(const Words& words) {
    const std::uint32_t pairs[] = {words[0] | words[1] << 16, words[2] | words[3] << 16, words[4] | words[5] << 16};
    std::memcpy(words_, pairs, sizeof pairs);
  }

  std::uint16_t words_[kCount] = {};
};

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

  static std::uint32_t error_bits(float error) {
    const float units = std::clamp(error * kErrorUnits, -kLargestError, kLargestError);
    return static_cast<std::uint32_t>(static_cast<std::int32_t>(units + (units < 0 ? -0.5f : 0.5f))) << 24;
  }
  static std::uint32_t to_byte(float x) { return static_cast<std::uint32_t>(x * 255.0f + 0.5f); }

  std::uint32_t word_ = kMostTriangles;  // triangle, merged, error
  std::uint32_t payload_ = 0;
};
static_assert(sizeof(OwnerSlot) == 8);

template <std::size_t Words, std::size_t Slots>  // 32 positions a word
struct OpenPixel {
  // States of a position.
  static constexpr std::uint32_t kEmpty = 0;          // nothing covers it yet
  static constexpr std::uint32_t kFirstSlot = 1;      // the first slot owns it; the next states are the other slots
  static constexpr std::uint32_t kFinal = Slots + 1;  // nothing that comes later can be nearer
  static constexpr std::size_t kBits = std::bit_width(kFinal);

  PositionStates<Words, kBits> states{};
  OwnerSlot slots[Slots];
  ColorSums colors;    // of what is final
  FixedSum area;       // of what is final, by analytic area; the number of its positions is the counted area
  FixedSum specks[2];  // the areas of visible specks that face away from the viewer, and towards the viewer

  // Size in the modelled machine. Here a pixel has two bytes more, so that the words of the next pixel are aligned.
  static constexpr std::uint32_t kBytes =
      sizeof(states) + sizeof(slots) + sizeof(colors) + sizeof(area) + sizeof(specks);

  static constexpr std::uint32_t owned_by(std::size_t slot) { return kFirstSlot + static_cast<std::uint32_t>(slot); }
};

static_assert(OpenPixel<8, 5>::kBytes == 154);
static_assert(OpenPixel<4, 7>::kBytes == 138);
static_assert(OpenPixel<2, 4>::kBytes == 74);
static_assert(OpenPixel<1, 2>::kBytes == 42);

// Depths of a pixel's owners, which the modelled machine computes again whenever it needs them. This program keeps
// them.
template <std::size_t Slots>
class OwnerDepths {
 public:
  DepthPlane<float> plane(std::size_t k) const { return {rows_[0][k], rows_[1][k], rows_[2][k]}; }
  float farthest(std::size_t k) const { return rows_[3][k]; }
  void set(std::size_t k, const DepthPlane<float>& plane, float farthest) {
    rows_[0][k] = plane.z, rows_[1][k] = plane.dzdu, rows_[2][k] = plane.dzdv, rows_[3][k] = farthest;
  }

  // Rows of all slots, from each of which a vector of std::bit_ceil(Slots) may be read.
  DepthPlane<const float*> planes() const { return {rows_[0], rows_[1], rows_[2]}; }

 private:
  float rows_[4][Slots];  // z, dzdu, dzdv, and the upper bound of the depth in the pixel
};

// The open pixels of a tile, row by row.
template <std::size_t Words, std::size_t Slots>
struct OpenPixels {
  // All are copies of one: g++ clears a pixel with `rep stos`, which takes longer to start than to clear so few bytes.
  explicit OpenPixels(std::size_t count)
      : pixels(count, OpenPixel<Words, Slots>()), depths(std::make_unique_for_overwrite<OwnerDepths<Slots>[]>(count)) {}

  std::vector<OpenPixel<Words, Slots>> pixels;
  std::unique_ptr<OwnerDepths<Slots>[]> depths;  // not set before a slot has an owner
};

// Size of a fragment between beam_fragment and compose in the modelled machine: pixel and facing (16 bits), triangle
// (24), centroid (16), area (16), mask, and depth plane and nearest depth as 4 x float32.
constexpr std::uint32_t owners_fragment_bytes(std::size_t words) {
  return 2 + 3 + 2 + 2 + static_cast<std::uint32_t>(words) * 4 + 16;
}

// The instances that exist: X(words, slots). 4 words with 7 slots are for streaming order, the others for near-first
// order: its default, and those that specs can name.
#define BEAMPIPE_SLOT_COUNTS(X, words) X(words, 2) X(words, 4) X(words, 8) X(words, 16) X(words, 32)
#define BEAMPIPE_OPEN_PIXELS(X) \
  BEAMPIPE_SLOT_COUNTS(X, 1)    \
  BEAMPIPE_SLOT_COUNTS(X, 2) BEAMPIPE_SLOT_COUNTS(X, 4) BEAMPIPE_SLOT_COUNTS(X, 8) X(8, 5) X(4, 7)

// Calls shape.operator()<Words, Slots>() with the numbers of the instance. Throws std::invalid_argument if there is no
// such instance.
template <class Shape>
auto with_shape(int positions, int slots, Shape&& shape) {
#define BEAMPIPE_SHAPE(words, pixel_slots) \
  if (positions == 32 * words && slots == pixel_slots) return shape.template operator()<words, pixel_slots>();
  BEAMPIPE_OPEN_PIXELS(BEAMPIPE_SHAPE)
#undef BEAMPIPE_SHAPE
  throw std::invalid_argument("no pixel has " + std::to_string(positions) + " positions and " + std::to_string(slots) +
                              " slots");
}

}  // namespace beampipe
