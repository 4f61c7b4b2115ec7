#include "stages/data/position_set.h"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

#include "simd/wide_mask.h"

namespace beampipe {

PositionSet::PositionSet(std::vector<SamplePattern> words) : patterns(std::move(words)), offsets(offsets_of(patterns)) {
  for (std::size_t i = 0; i < static_cast<std::size_t>(count()); ++i) {
    const SamplePattern& pattern = patterns[i / kMaxMaskSamples];
    const auto part = [&](int parts) {
      const int column = pattern.x[i % kMaxMaskSamples] * parts / kSubpixelUnits;
      const int row = pattern.y[i % kMaxMaskSamples] * parts / kSubpixelUnits;
      return static_cast<std::size_t>(row * parts + column);
    };
    quarters[part(2)].set(i);
    sixteenths[part(4)].set(i);
  }
  for (int y = 0; y < kPlaces; ++y) {
    for (int x = 0; x < kPlaces; ++x) {
      // Squared distance in 1/256 px, then the position's number, so that the lower number wins a tie.
      std::array<std::pair<int, int>, kMaxMaskWords * kMaxMaskSamples> by_distance;
      for (int i = 0; i < count(); ++i) {
        const SamplePattern& pattern = patterns[static_cast<std::size_t>(i / kMaxMaskSamples)];
        const auto s = static_cast<std::size_t>(i % kMaxMaskSamples);
        constexpr int kPlace = kSubpixelUnits / kPlaces;
        const int dx = pattern.x[s] - (x * kPlace + kPlace / 2), dy = pattern.y[s] - (y * kPlace + kPlace / 2);
        by_distance[static_cast<std::size_t>(i)] = {dx * dx + dy * dy, i};
      }
      std::partial_sort(by_distance.begin(), by_distance.begin() + 3, by_distance.begin() + count());
      nearest.push_back({static_cast<std::uint8_t>(by_distance[0].second),
                         static_cast<std::uint8_t>(by_distance[1].second),
                         static_cast<std::uint8_t>(by_distance[2].second)});
    }
  }
}

const std::array<std::uint8_t, 3>& PositionSet::nearest_to(float u, float v) const {
  return nearest[static_cast<std::size_t>(place_of(v) * kPlaces + place_of(u))];
}

namespace {

template <int kCount>
const PositionSet& the_set() {
  static const PositionSet set(cell_patterns(kCount));
  return set;
}

}  // namespace

const PositionSet& cell_positions(int count) {
  switch (count) {
    case 32:
      return the_set<32>();
    case 64:
      return the_set<64>();
    case 128:
      return the_set<128>();
    case 256:
      return the_set<256>();
    default:
      throw std::invalid_argument("expected 32, 64, 128 or 256 positions, found " + std::to_string(count));
  }
}

}  // namespace beampipe
