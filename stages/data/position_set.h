// Mask positions, and for every place in the pixel the three positions that are nearest to it.
#pragma once

#include <array>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "simd/plane_order.h"
#include "simd/sample_pattern.h"
#include "simd/scalar.h"
#include "simd/wide_mask.h"

namespace beampipe {

struct PositionSet {
  static constexpr int kPlaces = 64;  // places per axis in the table `nearest`
  std::vector<SamplePattern> patterns;
  std::vector<PositionOffsets> offsets;              // of the patterns
  std::vector<std::array<std::uint8_t, 3>> nearest;  // kPlaces x kPlaces, row by row
  // The positions in each quarter and in each sixteenth of the pixel, row by row.
  std::array<WideMask, 4> quarters;
  std::array<WideMask, 16> sixteenths;

  explicit PositionSet(std::vector<SamplePattern> patterns);
  int count() const { return static_cast<int>(patterns.size()) * kMaxMaskSamples; }
  // The place along one axis. For numbers and for numbers that count.
  template <class Float>
  static auto place_of(const Float& x) {
    const auto place = to_integer(x * Float(kPlaces));
    using Int = std::remove_const_t<decltype(place)>;
    return lesser(greater(place, Int(0)), Int(kPlaces - 1));
  }
  // (u, v): pixels from the pixel's upper left corner, 0..1.
  const std::array<std::uint8_t, 3>& nearest_to(float u, float v) const;
};

// The set of cell_patterns(count), which is made only once. `count`: 32, 64, 128 or 256; throws std::invalid_argument.
const PositionSet& cell_positions(int count);

}  // namespace beampipe
