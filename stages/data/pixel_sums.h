// Sums of what is final in a pixel, in few bits: areas in fixed point, and colours with one exponent for all.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "simd/scalar.h"

namespace beampipe {

// A number from 0 to almost 2 in 16 bits. Sums of areas and colours are kept in it: a sum of fp16 numbers stops growing
// when addends are small.
struct FixedSum {
  static constexpr float kUnits = 32768.0f;
  std::uint16_t units = 0;

  // The formulas, for numbers and for numbers that count.
  template <class Int>
  static auto value(const Int& units) {
    const auto number = to_float(units);
    return number * decltype(number * number)(1 / kUnits);
  }
  template <class Int, class Float>
  static Int sum(const Int& units, const Float& x, const Float& threshold) {
    const Int added = to_integer(x * Float(kUnits) + Float(1.0f) - threshold);
    return lesser(greater(units + added, Int(0)), Int(0xffff));
  }

  operator float() const { return value(static_cast<std::int32_t>(units)); }
  // `threshold`: 0..1, different for each addend. The part of a unit above it counts as a whole unit, so that many
  // small addends are right on average.
  void add(float x, float threshold) {
    units = static_cast<std::uint16_t>(sum(static_cast<std::int32_t>(units), x, threshold));
  }
};

// Sums of colours: RGB by analytic area, and RGB by counted positions, in 12 bytes. Each has 15 bits; the sixteenth
// bits together are the exponent of all six, which grows with the largest sum. Colours are linear RGB times area.
class ColorSums {
 public:
  static constexpr std::size_t kCount = 6;
  using Words = std::array<std::uint32_t, kCount>;  // of 16 bits

  std::array<float, kCount> values() const {
    const Words words = load();
    std::uint32_t power = 0;
    for (std::size_t i = 0; i < kCount; ++i) power |= words[i] >> 15 << i;
    std::array<float, kCount> values;
    for (std::size_t i = 0; i < kCount; ++i)
      values[i] = static_cast<float>(words[i] & kLargest) * unit(static_cast<int>(power));
    return values;
  }

  // `addends` are not negative. `threshold`: as in FixedSum.
  void add(const float (&addends)[kCount], float threshold) {
    Words words = load();
    add_to(words.data(), addends, threshold);
    store(words);
  }

  // The words are loaded and stored together: a load of several waits if they were stored one by one just before.
  [[gnu::always_inline]] Words load() const {
    std::uint32_t pairs[kCount / 2];
    std::memcpy(pairs, words_, sizeof pairs);
    return {pairs[0] & 0xffff, pairs[0] >> 16, pairs[1] & 0xffff, pairs[1] >> 16, pairs[2] & 0xffff, pairs[2] >> 16};
  }
  [[gnu::always_inline]] void store(const Words& words) {
    const std::uint32_t pairs[] = {words[0] | words[1] << 16, words[2] | words[3] << 16, words[4] | words[5] << 16};
    std::memcpy(words_, pairs, sizeof pairs);
  }

  // The formula, for numbers and for numbers that count. Words of 16 bits; their exponent is control flow.
  template <class Word, class Float>
  static void add_to(Word* words, const Float (&addends)[kCount], const Float& threshold) {
    Word exponent = words[0] >> 15;
    for (std::size_t i = 1; i < kCount; ++i) exponent = exponent | (words[i] >> 15) << static_cast<int>(i);
    Word largest = bits_of(addends[0]);  // floats that are not negative are in the order of their bits
    for (std::size_t i = 1; i < kCount; ++i) largest = greater(largest, bits_of(addends[i]));
    for (std::size_t i = 0; i < kCount; ++i) words[i] = words[i] & Word(kLargest);
    const int before = static_cast<int>(plain(exponent));
    int power = std::max(before, least_exponent(plain(largest >> 23)));
    if (power > before) halve(words, power - before);
    for (; power < kMostExponent && !fits(words, addends, Float(per_unit(power))); ++power) halve(words, 1);
    const Float scale(per_unit(power));
    for (std::size_t i = 0; i < kCount; ++i) {
      const Word sum = words[i] + to_bits(lesser(addends[i] * scale, Float(kLargest)) + Float(1.0f) - threshold);
      words[i] = lesser(sum, Word(kLargest)) | Word(static_cast<std::uint32_t>(power) >> i & 1) << 15;
    }
  }

 private:
  static constexpr std::uint32_t kLargest = 0x7fff;
  static constexpr int kMostExponent = 63;

  // Units from 2^-40, so that sums up to 2^-25 are exact to that, to 2^23.
  static float unit(int power) { return std::bit_cast<float>(static_cast<std::uint32_t>(power - 40 + 127) << 23); }
  static float per_unit(int power) { return std::bit_cast<float>(static_cast<std::uint32_t>(40 - power + 127) << 23); }

  // The largest addend does not fit with any smaller exponent, whatever the sums are: it would be 2^15 units or more.
  static int least_exponent(std::uint32_t exponent_of_largest) {
    return std::min(static_cast<int>(exponent_of_largest & 0xff) - 127 + 40 - 14, kMostExponent);
  }

  // Rounded up, as if it were halved again and again.
  template <class Word>
  static void halve(Word* words, int times) {
    const int shift = std::min(times, 15);
    for (std::size_t i = 0; i < kCount; ++i) words[i] = (words[i] + Word((1u << shift) - 1)) >> shift;
  }

  template <class Word, class Float>
  static bool fits(const Word* sums, const Float (&addends)[kCount], const Float& per_unit) {
    for (std::size_t i = 0; i < kCount; ++i)
      if (!(to_float(sums[i]) + addends[i] * per_unit + Float(1.0f) < Float(kLargest))) return false;
    return true;
  }

  std::uint16_t words_[kCount] = {};
};

// What a pixel keeps of surfaces that are final, beside their area, which stands in the pixel's word.
struct PixelSums {
  ColorSums colors;
  FixedSum specks[2];  // the areas of visible specks that face away from the viewer, and towards the viewer
};
static_assert(sizeof(PixelSums) == 16);

}  // namespace beampipe
