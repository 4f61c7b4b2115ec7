// Mask positions, and the three nearest of them to every place in the pixel.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "simd/sample_pattern.h"

namespace beampipe {

struct PositionSet {
  static constexpr int kPlaces = 64;  // places per axis that are told apart
  std::vector<SamplePattern> patterns;
  std::vector<std::array<std::uint8_t, 3>> nearest;  // kPlaces x kPlaces, row by row

  explicit PositionSet(std::vector<SamplePattern> patterns);
  int count() const { return static_cast<int>(patterns.size()) * kMaxMaskSamples; }
  const std::array<std::uint8_t, 3>& nearest_to(float u, float v) const;  // u, v in 0..1
};

// That of cell_patterns(count); made once.
const PositionSet& cell_positions(int count);

}  // namespace beampipe
